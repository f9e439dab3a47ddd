#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "slalom/core/math.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::vehicle::detail {

/// Computes the time lost behind each other car, from its speed so far as a share of the path's speed.
class PaceOfOthers {
 public:
  /// Assumes that a car stays behind another for `steps_behind` time steps. `control_period` (s) is the time
  /// between calls of `steps_lost`.
  PaceOfOthers(double steps_behind, double control_period) noexcept
      : steps_behind_(steps_behind),
        weight_of_new_(std::min(control_period / memory, 1.0)),
        weight_of_latest_(std::min(control_period / short_memory, 1.0)) {}

  /// Notes the speeds of these cars. Returns for each the number of time steps that the own car loses behind
  /// it: 0 unless that car is slower than the path, close ahead, and drives the same way. `own` and `field`
  /// are relative to `origin` (m, map frame). Valid until the next call.
  std::span<const double> steps_lost(std::span<const maps::PredictedObstacle* const> others,
                                     const maps::ReferenceField& field, const maps::Point& origin,
                                     const maps::Pose& own) noexcept {
    ++calls_;
    for (std::size_t i = 0; i < others.size(); ++i) {
      const maps::PredictedObstacle& other = *others[i];
      // The first pose may hold an error of the tracker, so the next two give the direction and the speed.
      const maps::Pose from = other.at(other.likeliest(), other.interval).pose,
                       to = other.at(other.likeliest(), 2 * other.interval).pose;
      const maps::Pose place{from.x - origin.x, from.y - origin.y, from.yaw};
      const maps::ReferenceCell path = field.at(place.x, place.y);
      Pace& pace = pace_of(other.id);
      if (path.distance < field.options().outside.distance && path.speed >= slowest_path &&
          std::abs(wrap_angle(place.yaw - double(path.yaw))) < same_way) {
        const double share = std::hypot(to.x - from.x, to.y - from.y) / other.interval / double(path.speed);
        // A car that speeds up, as after a start, has not shown its pace yet.
        if (share < pace.latest + rising) pace.share += weight_of_new_ * (share - pace.share);
        pace.latest += weight_of_latest_ * (share - pace.latest);
      }
      lost_[i] = follows(own, place) ? steps_behind_ * std::clamp(1 - pace.share, 0.0, largest_share) : 0;
    }
    return {lost_.data(), others.size()};
  }

  /// Forgets all cars.
  void reset() noexcept { paces_ = {}; }

 private:
  static constexpr auto max_count = static_cast<std::size_t>(maps::MovingObstacles::max_count);
  static constexpr double memory = 3;              ///< s, time constant of the mean of a car's speed
  static constexpr double short_memory = 0.15;     ///< s, of the mean that shows whether a share rises
  static constexpr double rising = 0.05;           ///< share of the path's speed above that mean, of a rise
  static constexpr double largest_share = 0.25;    ///< largest share of the time that counts as lost: a
                                                   ///< standing car need not be passed at any risk
  static constexpr double behind = 10, ahead = 1;  ///< m along the other car, where the own car follows it
  static constexpr double beside = 3;              ///< m across it
  static constexpr double same_way = 1;            ///< rad, between cars, and between a car and the path
  static constexpr double slowest_path = 0.5;      ///< m/s; for a slower path the share says nothing

  /// The memory of a car.
  struct Pace {
    int id = 0;
    double share = 1;   ///< mean of its speed as a share of the path's
    double latest = 0;  ///< the same over a short time
    long noted = 0;     ///< call of `steps_lost` at which it was seen last; 0: no car
  };

  static bool follows(const maps::Pose& own, const maps::Pose& other) noexcept {
    const maps::Point place = maps::inverse_transform(other, {own.x, own.y});
    return place.x > -behind && place.x < ahead && std::abs(place.y) < beside &&
           std::abs(wrap_angle(own.yaw - other.yaw)) < same_way;
  }

  /// Returns the memory of this car. A new car replaces the one that was seen longest ago.
  Pace& pace_of(int id) noexcept {
    auto found = std::find_if(paces_.begin(), paces_.end(),
                              [id](const Pace& each) { return each.noted > 0 && each.id == id; });
    if (found == paces_.end()) {
      found = std::min_element(paces_.begin(), paces_.end(),
                               [](const Pace& a, const Pace& b) { return a.noted < b.noted; });
      *found = {.id = id};
    }
    found->noted = calls_;
    return *found;
  }

  double steps_behind_, weight_of_new_, weight_of_latest_;
  long calls_ = 0;
  std::array<Pace, max_count> paces_{};
  std::array<double, max_count> lost_{};
};

}  // namespace slalom::vehicle::detail
