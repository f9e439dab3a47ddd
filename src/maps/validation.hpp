#pragma once

#include <sstream>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"
#include "slalom/maps/cell_grid.hpp"

namespace slalom::maps::detail {

/// Throws std::invalid_argument that names field, value and rule unless `holds`.
template <class T>
void require(bool holds, const char* field, const T& value, const char* rule) {
  if (holds) return;
  std::ostringstream text;
  text << field << ": " << value << ": must be " << rule;
  throw std::invalid_argument(text.str());
}

/// The cells of a map with these options, around the origin. Checks the options; throws where there are no
/// cells or too many.
template <class Options>
GridGeometry geometry_of(const Options& options, const std::string& where) {
  validate_options(options, where);
  const auto cells = [&](const char* field, double length) {
    const double count = std::round(length / options.resolution);
    require(count >= 1 && count <= 20000, (where + field).c_str(), length, "1 to 20000 cells long");
    return saturate_cast<int>(count);
  };
  return {cells(".length_x", options.length_x), cells(".length_y", options.length_y), options.resolution};
}

}  // namespace slalom::maps::detail
