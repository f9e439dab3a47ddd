#pragma once

#include <array>
#include <span>

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

/// The numbers of PaceOfOthers.
struct PaceLimits {
  CarScale car;
  double memory = 3 * car.speed;           ///< s, time constant of the mean of a car's speed
  double short_memory = 0.15 * car.speed;  ///< s, of the mean that shows whether a share rises
  double rising = 0.05;                    ///< share of the path's speed above that mean, of a rise
  double largest_share = 0.25;             ///< share of the time that counts as lost, at most: a standing car
                                           ///< need not be passed at any risk
  double behind = 10 * car.length;         ///< m along the other car, where the own car follows it
  double ahead = 1 * car.length;           ///< m along the other car, up to which it still does
  double beside = 3 * car.length;          ///< m across it
  double slowest_path = 0.5 * car.speed;   ///< m/s; for a slower path the share says nothing
};

/// Computes the time lost behind each other car, from its speed so far as a share of the path's speed.
class PaceOfOthers {
 public:
  /// Assumes that a car stays behind another for `steps_behind` time steps. `control_period` (s) is the time
  /// between calls of `steps_lost`.
  PaceOfOthers(double steps_behind, double control_period, const CarScale& car) noexcept;

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
  bool follows(const maps::Pose& own, const maps::Pose& other) const noexcept;
  Pace& pace_of(int id) noexcept;

  PaceLimits limits_;
  double steps_behind_, weight_of_new_, weight_of_latest_;
  long calls_ = 0;
  std::array<Pace, max_count> paces_{};
  std::array<double, max_count> lost_{};
};

}  // namespace slalom::vehicle::detail
