#pragma once

#include <span>
#include <vector>

#include "slalom/evaluation/racing_lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::evaluation {

/// The belief about the usable grip along a course: a share of friction times gravity
/// (SingleTrackOptions::usable_grip) for each of its equal parts, from its first point.
using GripBelief = std::vector<double>;

/// `configuration` with this belief, as `vehicle.usable_grip` and `planner.grip_shares`: the options of plans
/// that seek the shortest time. The belief must not be empty.
vehicle::Configuration with_belief(const vehicle::Configuration& configuration, const GripBelief& belief);

/// Learns the usable grip of each part of a course from lap to lap: more where the lap stayed inside the
/// friction circle, less where it went beyond, so that each part uses what the circle allows. After a lap
/// that was not completed, the next belief is that of the fastest lap, with less grip where the lap ended.
/// Once a lap has ended so, or a part has gone beyond the circle, that part is never given as much again,
/// unless that is the least belief.
class GripLearning {
 public:
  static constexpr double least = 0.3, most = 1;  ///< bounds of the belief in a part

  /// A course of `length` (m > 0) on which laps begin `start` (m, >= 0) after its first point, with the
  /// belief before the first lap, which is the same for all of `parts` (>= 1) parts and in [least, most], and
  /// the radius of the circle (m/s^2, > 0). Throws std::invalid_argument where these rules are broken.
  GripLearning(double length, double start, int parts, double belief, double circle);

  /// The belief for the next lap.
  const GripBelief& next() const noexcept { return next_; }
  /// Learns from a lap that was driven with `next()`; it must have samples.
  void learn(const RacingLap& lap);

  /// The number of laps in a row, up to the last, that were not at least 0.1 % faster than the fastest before
  /// them.
  int without_gain() const noexcept { return without_gain_; }
  /// The belief of the fastest completed lap; empty before one.
  const GripBelief& best() const noexcept { return best_; }

 private:
  int part_at(double distance) const noexcept;
  std::vector<double> use(const RacingLap& lap) const;
  void lower(int part) noexcept;

  double length_, start_, circle_;
  GripBelief next_, best_;
  std::vector<double> most_;  ///< largest share of each part that is not known to be too much
  double best_time_;
  int without_gain_ = 0;
};

}  // namespace slalom::evaluation
