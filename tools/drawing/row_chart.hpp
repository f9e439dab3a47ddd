#pragma once

#include <optional>
#include <vector>

#include "tools/drawing/drawing.hpp"

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

/// A value and how sure it is, or how far it reaches.
struct Span {
  double value = 0, low = 0, high = 0;
};

/// The contents of a row of a panel: all values (a box), or one value with a span. Empty without values.
struct Marks {
  std::vector<double> values;
  std::optional<Span> span;
};

/// A column of a chart: the same quantity for every row.
struct Panel {
  enum class Kind {
    boxes,  ///< quartiles, whiskers to 1.5 times their distance, values beyond as points, mean as a diamond;
            ///< logarithmic
    bars,   ///< from 0, with their spans; linear
  };
  std::string title, axis;
  Kind kind = Kind::boxes;
  std::vector<Marks> ours, theirs;  ///< a row each; `theirs` may be empty
};

/// Rows of names with panels beside them.
struct RowChart {
  std::vector<std::string> names;
  std::vector<Panel> panels;
  std::string title, note;  ///< lines above the chart
  std::string their_key;    ///< name of the other colour; no key without it
};

Drawing draw_chart(const RowChart& chart);

}  // namespace slalom::tools
