#include "tools/drawing/axis.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::tools {
namespace {

/// The least of 1, 2 and 5 times a power of ten that is not below `rough`, which must be above 0.
double round_step(double rough) {
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * decade >= rough) return digit * decade;
  return 10 * decade;
}

}  // namespace

double Axis::operator()(double value) const {
  const double share = logarithmic
                           ? std::clamp(std::log(std::max(value, low) / low) / std::log(high / low), 0.0, 1.0)
                           : (value - low) / (high - low);
  return from + (to - from) * share;
}

Axis linear_axis(double low, double high, double from, double to, int steps, bool exact) {
  const double step = round_step((high - low) / steps);
  Axis axis{.low = low, .high = high, .from = from, .to = to, .ticks = {}};
  if (!exact) {
    axis.low = step * std::floor(low / step + 1e-9);
    axis.high = step * std::ceil(high / step - 1e-9);
  }
  // Counted, since a step is lost in a value of many more digits.
  const double first = std::ceil(axis.low / step - 1e-9);
  for (int k = 0; k <= 2 * steps + 2 && step * (first + k) <= axis.high + 1e-9 * step; ++k)
    axis.ticks.push_back(first + k == 0 ? 0 : step * (first + k));
  return axis;
}

Axis logarithmic_axis(double low, double high, double from, double to) {
  Axis axis{.low = 1e-9, .high = 1e9, .from = from, .to = to, .logarithmic = true, .ticks = {}};
  std::vector<double> steps;
  for (int decade = -9; decade < 9; ++decade)
    for (const double digit : {1.0, 2.0, 5.0})
      if (digit == 1 || high <= 200 * low) steps.push_back(digit * std::pow(10.0, decade));
  for (const double step : steps)
    if (step <= low) axis.low = step;
  axis.high = *std::find_if(steps.begin(), steps.end() - 1,
                            [&](double step) { return step >= high && step > axis.low; });
  for (const double step : steps)
    if (step >= axis.low * 0.999 && step <= axis.high * 1.001) axis.ticks.push_back(step);
  return axis;
}

}  // namespace slalom::tools
