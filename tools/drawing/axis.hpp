#pragma once

#include <vector>

namespace slalom::tools {

/// An axis of a chart: maps values to pixels.
struct Axis {
  double low = 0, high = 1;   ///< values at the ends
  double from = 0, to = 1;    ///< pixels at the ends
  bool logarithmic = false;   ///< spaces values evenly by their logarithms
  std::vector<double> ticks;  ///< values with a line of the grid

  /// The pixel of a value; values of a logarithmic axis are moved to its ends.
  double operator()(double value) const;
};

/// A linear axis between two pixels that shows the values from `low` to `high`, which must differ, with about
/// `steps` steps between its lines. It ends at lines, or exactly at these values.
Axis linear_axis(double low, double high, double from, double to, int steps, bool exact = false);

/// A logarithmic axis between two pixels that shows the values from `low` to `high`, 0 < low <= high. Its
/// lines are at 1, 2 and 5 times powers of ten, or at powers of ten alone if `high` exceeds 200 `low`.
Axis logarithmic_axis(double low, double high, double from, double to);

}  // namespace slalom::tools
