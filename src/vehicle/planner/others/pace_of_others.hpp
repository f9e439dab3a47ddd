#pragma once

#include <array>
#include <span>

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::vehicle::detail {

/// The time that the car would lose behind each other car, from how fast that one has driven so far, as a
/// share of the path's speed.
class PaceOfOthers {
 public:
  /// A car that stays behind another is taken to do so for `steps_behind` time steps. `control_period`: s
  /// between calls of `steps_lost`.
  PaceOfOthers(double steps_behind, double control_period) noexcept;

  /// Notes the speeds of these cars, and returns for each how many time steps the car loses that stays behind
  /// it: 0 unless it is slower than the path, near ahead of the own car, and drives the same way. `own` and
  /// `field` are in the frame that begins at `origin` (m, map frame). Valid until the next call.
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
