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

/// The colour 0xRRGGBB.
constexpr Colour hex(unsigned rgb, double opacity = 1) {
  return {(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, opacity};
}

// Colours by meaning, which are those of the page in its light theme (view/page/src/scene/palette.ts).
inline constexpr Colour plan_colour = hex(0x007a3d), guide_colour = hex(0xa01bb0), hit_colour = hex(0xc93410),
                        nominal_colour = hex(0x20262e, 0.7), driven_colour = hex(0x6b7787, 0.9),
                        path_colour = hex(0x6b7a8d, 0.6), obstacle_colour = hex(0xd98518),
                        obstacle_rim = hex(0x5c3500), opponent_colour = hex(0x1273b8);
/// Colours of a quantity, such as a cost, from low to high, for any kind of colour vision and in grey.
inline constexpr Colour quantity_stops[] = {hex(0x003d79), hex(0x36577c), hex(0x646f7b),
                                            hex(0x8c8777), hex(0xb2a16e), hex(0xdabb5c)};

/// The colour of a method in every picture, by its name, which may be followed by more words. Other names
/// have a colour of their own, too, but may share it.
Colour method_colour(std::string_view name);

/// `a` at share 0, `b` at share 1, linear between them.
Colour mixed(Colour a, Colour b, double share);

/// The colour of a value in [0, 1] on a scale through `stops` at equal distances.
Colour scale_colour(std::span<const Colour> stops, double value);

/// The colour of a sample by its cost in [0, 1].
inline Colour cost_colour(double cost, double opacity) {
  Colour colour = scale_colour(quantity_stops, cost);
  colour.opacity = opacity;
  return colour;
}

/// The colour of a value in [0, 1] on the scale of quantities, from slow (yellow) to fast (blue).
inline Colour speed_colour(double value) {
  return scale_colour(quantity_stops, 1 - value);
}

}  // namespace slalom::tools
