#pragma once

#include <vector>

namespace slalom::tools {

/// The least of 1, 2 and 5 times a power of ten that is not below `rough`, which must be above 0.
double round_step(double rough);

/// An axis whose values are evenly spaced, and where its lines are.
struct LinearAxis {
  double low = 0, high = 1;   ///< values at the ends
  double from = 0, to = 1;    ///< pixels at the ends
  std::vector<double> ticks;  ///< values

  double operator()(double value) const { return from + (to - from) * (value - low) / (high - low); }
};

/// An axis between two pixels that shows the values from `low` to `high`, which must differ, with about
/// `steps` steps between its lines. `exact`: it ends at these values, else at lines.
LinearAxis make_linear_axis(double low, double high, double from, double to, int steps, bool exact = false);

}  // namespace slalom::tools
