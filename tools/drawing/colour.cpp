#include "tools/drawing/colour.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace slalom::tools {

Colour mixed(Colour a, Colour b, double share) {
  return {a.red + share * (b.red - a.red), a.green + share * (b.green - a.green),
          a.blue + share * (b.blue - a.blue), a.opacity + share * (b.opacity - a.opacity)};
}

Colour speed_colour(double value) {
  static const std::array<Colour, 6> stops = {{{0.16, 0.22, 0.62},
                                               {0.08, 0.47, 0.76},
                                               {0.05, 0.64, 0.55},
                                               {0.55, 0.74, 0.20},
                                               {0.96, 0.66, 0.11},
                                               {0.86, 0.19, 0.18}}};
  const double at = std::clamp(value, 0.0, 1.0) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mixed(stops[i], stops[i + 1], at - static_cast<double>(i));
}

}  // namespace slalom::tools
