#pragma once

#include <span>
#include <string_view>

namespace slalom::tools {

/// A colour, each part in [0, 1].
struct Colour {
  double red = 0, green = 0, blue = 0, opacity = 1;
};

inline constexpr Colour ink{0.13, 0.16, 0.22};        ///< colour of text and lines
inline constexpr Colour faint_ink{0.42, 0.46, 0.54};  ///< colour of remarks
inline constexpr Colour rule{0.89, 0.91, 0.94};       ///< colour of the lines of a grid
inline constexpr Colour white{1, 1, 1};

/// The colour of a method in every picture, by its name, which may be followed by more words. Other names
/// have a colour of their own, too, but may share it.
Colour method_colour(std::string_view name);

/// `a` at share 0, `b` at share 1, linear between them.
Colour mixed(Colour a, Colour b, double share);

/// The colour of a value in [0, 1] on a scale through `stops` at equal distances.
Colour scale_colour(std::span<const Colour> stops, double value);

/// The colour of a value in [0, 1] on a scale from slow (blue) over green to fast (red), with a lightness
/// that can be read on white.
Colour speed_colour(double value);

}  // namespace slalom::tools
