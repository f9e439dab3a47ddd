#pragma once

#include <optional>

#include "tools/drawing/drawing.hpp"

namespace slalom::tools {

/// A value and how sure it is, or how far it reaches.
struct Span {
  double value = 0, low = 0, high = 0;
};

/// The contents of a row of a panel: all values (a box), or one value with a span. Empty if there is no
/// value.
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
