#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::maps::detail {

/// Throws std::invalid_argument that names field, value and rule unless `holds`.
template <class T>
void require(bool holds, const char* field, const T& value, const char* rule) {
  if (holds) return;
  std::ostringstream text;
  text << field << ": " << value << ": must be " << rule;
  throw std::invalid_argument(text.str());
}

/// How many cells make up a length (both above 0); throws where there are none or too many.
inline int cell_count(const char* field, double length, double resolution) {
  const double count = std::round(length / resolution);
  require(count >= 1 && count <= 20000, field, length, "1 to 20000 cells long");
  return saturate_cast<int>(count);
}

}  // namespace slalom::maps::detail
