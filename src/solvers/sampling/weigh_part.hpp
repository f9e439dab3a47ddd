#pragma once

#include <algorithm>
#include <cmath>

#include "solvers/sampling/sample_set.hpp"
#include "solvers/sampling/seek_temperature.hpp"

namespace slalom::detail {

/// Weighs the samples `first` to `end` of a set, and the others with 0. The weights sum to 1. Their effective
/// sample size is `effective`, for which `temperature` is sought from its last value, unless a temperature is
/// `given` (above 0). Returns the sums of the weights before they were normalised; without a finite cost all
/// are 0.
inline WeightSums<double> weigh_part(SampleSet& set, int first, int end, double effective, double given,
                                     double& temperature) noexcept {
  const float* const costs = set.costs().data();
  const float least = first < end ? *std::min_element(costs + first, costs + end) : INFINITY;
  if (!std::isfinite(least)) {
    std::fill(set.weights().begin(), set.weights().end(), 0.0f);
    return {};
  }
  float* const totals = set.totals().data();
  std::fill_n(totals, set.stride(), INFINITY);
  std::copy(costs + first, costs + end, totals + first);
  WeightSums<double> all;
  const Range range{0, set.stride()};
  const auto weigh_at = [&](double value) {
    const WeightSums<float> sums = kernels::exponential_weights(
        totals, costs, least, static_cast<float>(value), range, set.weights().data());
    all = {sums.weight, sums.squared, sums.cost};
    return all.effective();
  };
  const double excess = mean_excess({totals + first, totals + end}, least);
  if (given > 0) {
    temperature = given;
  } else {
    temperature = excess > 0 ? seek_temperature(std::max(effective, 1.0), excess, temperature, weigh_at) : 1;
  }
  weigh_at(temperature);
  kernels::scale(static_cast<float>(1 / all.weight), range, set.weights().data());
  return all;
}

}  // namespace slalom::detail
