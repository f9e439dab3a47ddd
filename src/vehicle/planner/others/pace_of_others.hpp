#pragma once

#include <array>
#include <span>

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::vehicle::detail {

/// Computes the time that the car would lose behind each other car, from the speed of that car so far as a
/// share of the path's speed.
class PaceOfOthers {
 public:
  /// Assumes that a car stays behind another for `steps_behind` time steps. `control_period` (s) is the time
  /// between calls of `steps_lost`.
  PaceOfOthers(double steps_behind, double control_period) noexcept;

  /// Notes the speeds of these cars. Returns for each the number of time steps that the own car loses behind
  /// it: 0 unless that car is slower than the path, close ahead, and drives the same way. `own` and `field`
  /// are relative to `origin` (m, map frame). Valid until the next call.
  std::span<const double> steps_lost(std::span<const maps::PredictedObstacle* const> others,
                                     const maps::ReferenceField& field, const maps::Point& origin,
                                     const maps::Pose& own) noexcept;

  /// Forgets all cars.
  void reset() noexcept { paces_ = {}; }

 private:
  static constexpr auto max_count = static_cast<std::size_t>(maps::MovingObstacles::max_count);

  /// The memory of a car.
  struct Pace {
    int id = 0;
    double share = 1;   ///< mean of its speed as a share of the path's
    double latest = 0;  ///< the same over a short time
    long noted = 0;     ///< call of `steps_lost` at which it was seen last; 0: no car
  };
  Pace& pace_of(int id) noexcept;

  double steps_behind_, weight_of_new_, weight_of_latest_;
  long calls_ = 0;
  std::array<Pace, max_count> paces_{};
  std::array<double, max_count> lost_{};
};

}  // namespace slalom::vehicle::detail
