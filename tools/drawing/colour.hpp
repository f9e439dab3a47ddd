#pragma once

namespace slalom::tools {

/// A colour, each part in [0, 1].
struct Colour {
  double red = 0, green = 0, blue = 0, opacity = 1;
};

/// `a` at share 0, `b` at share 1, linear between them.
Colour mixed(Colour a, Colour b, double share);

/// The colour of a value in [0, 1] on a scale from slow (blue) over green to fast (red), with a lightness
/// that can be read on white.
Colour speed_colour(double value);

}  // namespace slalom::tools
