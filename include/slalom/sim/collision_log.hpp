#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slalom/sim/world.hpp"

namespace slalom::sim {

/// Counts the collisions of a car, for instance over a lap.
class CollisionLog {
 public:
  /// Records the collisions of a step. Call it after each step of the world.
  void update(const World& world, std::size_t car);

  /// Number of collisions: different bodies that the car collided with, all walls together as one.
  int collisions() const noexcept { return static_cast<int>(bodies_.size()) + wall_; }
  bool hit_wall() const noexcept { return wall_; }  ///< whether it collided with a wall
  std::span<const int> bodies() const noexcept {
    return bodies_;
  }  ///< bodies with which it collided, ascending
  /// Number of different patterns of the fixed bodies' collision flags seen while the car collided, as the
  /// evaluation of K. Honda et al. (proj-svg_mppi) counts them. A wall alone is the pattern of no flag, two
  /// bodies at once are a pattern of their own.
  int flag_patterns() const noexcept { return static_cast<int>(patterns_.size()); }

 private:
  std::vector<int> bodies_;
  std::vector<std::vector<std::uint8_t>> patterns_;
  bool wall_ = false;
};

}  // namespace slalom::sim
