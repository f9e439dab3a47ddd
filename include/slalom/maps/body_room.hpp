#pragma once

#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// The factor by which a body of this length (m) is longer than that of a 1/10-scale car.
constexpr double body_scale(double length) {
  return length / (0.461 + 0.119);
}

/// The room that obstacles leave a body.
class BodyRoom {
 public:
  /// The distance (m) from a body at this pose to the nearest obstacle, beyond what it has to keep: below 0
  /// it is too near, minus infinity if it must never be there.
  virtual double at(const Pose& pose) const noexcept = 0;

 protected:
  ~BodyRoom() = default;
};

}  // namespace slalom::maps
