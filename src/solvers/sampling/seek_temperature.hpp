#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace slalom::detail {

/// The effective sample size that weights of `samples` samples should have, if no option states it.
/// docs/problem-suite.md has what it changes.
inline double default_effective_size(int samples) {
  return 0.6 * std::sqrt(static_cast<double>(samples));
}

/// Finds the temperature at which weights have the effective sample size `wanted`. It grows with the
/// temperature, so the logarithm of the temperature is bracketed with doubling steps, then found by false
/// position, until the size is within 1 %. `scale` is the mean excess of the costs over the least one, above
/// 0; `start` is the first temperature to try, or 0. `effective_size(temperature)` returns the size. If all
/// temperatures give a larger or a smaller size, the lowest or highest one of the search is returned. Costs
/// times a power of two give the temperature times that power, bit for bit.
template <class EffectiveSize>
double seek_temperature(double wanted, double scale, double start, EffectiveSize&& effective_size) {
  // Limits of the search, as logarithms of temperature / scale, and the largest error. The costs of samples
  // that diverge may exceed all others by 30 orders of magnitude; a temperature is a float.
  constexpr double highest = 7, tolerance = 0.01;
  const double lowest = std::clamp(std::log(1e-30 / scale), -80.0, -23.0);
  constexpr int maximum_trials = 40;
  struct Trial {
    double at, error;  // logarithms of temperature / scale and of effective sample size / wanted
  };
  std::optional<Trial> low, high;  // the last temperatures that were too low and too high
  double at = start > 0 ? std::clamp(std::log(start / scale), lowest, highest) : -2, stride = 1;
  bool was_too_low = false;
  for (int trial = 0; trial < maximum_trials; ++trial) {
    const double temperature = scale * std::exp(at);
    const double error = std::log(std::max(effective_size(temperature), 1e-3) / wanted);
    if (std::abs(error) < tolerance) return temperature;
    const bool too_low = error < 0;
    (too_low ? low : high) = Trial{at, error};
    if (low && high) {
      // The Illinois rule: if the same end remains twice, its error is halved, so that false position
      // converges quickly.
      if (too_low == was_too_low) (too_low ? high : low)->error /= 2;
      at = low->at + (high->at - low->at) * low->error / (low->error - high->error);
    } else if (at == (too_low ? highest : lowest)) {
      return temperature;
    } else {
      at = std::clamp(at + (too_low ? stride : -stride), lowest, highest);
      stride *= 2;
    }
    was_too_low = too_low;
  }
  return scale * std::exp(at);
}

/// The mean of the finite totals, relative to the lowest, `least`; 0 if none is finite.
inline double mean_excess(std::span<const float> totals, double least) noexcept {
  double sum = 0;
  int counted = 0;
  for (const float total : totals) {
    if (!std::isfinite(total)) continue;
    sum += total - least;
    ++counted;
  }
  return counted > 0 ? sum / counted : 0;
}

/// The temperature of the weights of samples with these totals, if no option states it; 1 if all are equal.
/// `least`: the lowest total.
template <class EffectiveSize>
double default_temperature(std::span<const float> totals, double least, EffectiveSize&& effective_size) {
  const double excess = mean_excess(totals, least);
  const double wanted = std::max(default_effective_size(static_cast<int>(totals.size())), 1.0);
  return excess > 0 ? seek_temperature(wanted, excess, 0, effective_size) : 1;
}

}  // namespace slalom::detail
