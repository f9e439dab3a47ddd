#include "solvers/sampling/weighting.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::detail {

namespace {

/// The limits of the search, as logarithms of the temperature: 1e-9 ... 1e12.
constexpr double lowest = -20.7, highest = 27.6;
/// Largest error of the effective sample size, as a logarithm, and the largest number of trials.
constexpr double tolerance = 0.01;
constexpr int maximum_trials = 40;

double effective(const WeightSums<double>& sums) {
  return sums.squared > 0 ? sums.weight * sums.weight / sums.squared : 0;
}

}  // namespace

WeightSums<double> Weighting::weigh(SampleSet& samples, float least, ThreadPool& pool) noexcept {
  return samples.weigh(least, static_cast<float>(temperature_), pool, static_cast<float>(settings_.index));
}

WeightSums<double> Weighting::try_temperature(SampleSet& samples, double logarithm,
                                              ThreadPool& pool) noexcept {
  temperature_ = std::exp(logarithm);
  return weigh(samples, samples.mix_totals(static_cast<float>(temperature_), pool), pool);
}

WeightSums<double> Weighting::seek(SampleSet& samples, ThreadPool& pool) noexcept {
  const double wanted = std::max(settings_.share * samples.samples(), 1.0);
  double at = std::clamp(std::log(temperature_), lowest, highest);
  double low = at, high = at, low_error = 0, high_error = 0, stride = 1;
  bool below = false, above = false;  // whether a temperature that is too low or too high is known
  int side = 0;                       // the side of the last trial: -1 below, 1 above
  for (int trial = 0; trial < maximum_trials; ++trial) {
    const WeightSums<double> sums = try_temperature(samples, at, pool);
    const double error = std::log(std::max(effective(sums), 1e-3) / wanted);
    if (std::abs(error) < tolerance) return sums;
    (error < 0 ? low : high) = at;
    (error < 0 ? low_error : high_error) = error;
    (error < 0 ? below : above) = true;
    if (below && above) {
      // The Illinois rule: the error of an end that remained twice is halved, so that false position
      // converges quickly.
      const int now = error < 0 ? -1 : 1;
      if (now == side) (error < 0 ? high_error : low_error) /= 2;
      side = now;
      at = low + (high - low) * low_error / (low_error - high_error);
    } else if ((error < 0 && at >= highest) || (error > 0 && at <= lowest)) {
      break;
    } else {
      at = std::clamp(at + (error < 0 ? stride : -stride), lowest, highest);
      stride *= 2;
    }
  }
  if (below && above) return try_temperature(samples, at, pool);
  return try_temperature(samples, std::log(settings_.temperature), pool);
}

}  // namespace slalom::detail
