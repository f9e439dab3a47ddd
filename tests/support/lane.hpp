#pragma once

#include "slalom/maps/reference_field.hpp"

namespace slalom::testing {

/// A straight lane along x, 60 m long, with a point each 0.1 m.
inline std::vector<maps::ReferencePoint> lane(double speed) {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 600; ++i) path.push_back({0.1 * i, 0, 0, speed});
  return path;
}

}  // namespace slalom::testing
