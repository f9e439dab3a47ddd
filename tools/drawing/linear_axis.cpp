#include "tools/drawing/linear_axis.hpp"

#include <cmath>

namespace slalom::tools {

double round_step(double rough) {
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * decade >= rough) return digit * decade;
  return 10 * decade;
}

LinearAxis make_linear_axis(double low, double high, double from, double to, int steps, bool exact) {
  const double step = round_step((high - low) / steps);
  LinearAxis axis{low, high, from, to, {}};
  if (!exact) {
    axis.low = step * std::floor(low / step + 1e-9);
    axis.high = step * std::ceil(high / step - 1e-9);
  }
  for (double tick = step * std::ceil(axis.low / step - 1e-9); tick <= axis.high + 1e-9 * step; tick += step)
    axis.ticks.push_back(std::abs(tick) < 1e-9 * step ? 0 : tick);
  return axis;
}

}  // namespace slalom::tools
