#include "vehicle/planner/obstacles/pace_of_others.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/math.hpp"

namespace slalom::vehicle::detail {

PaceOfOthers::PaceOfOthers(double steps_behind, double control_period, const CarScale& car) noexcept
    : limits_{car},
      steps_behind_(steps_behind),
      weight_of_new_(std::min(control_period / limits_.memory, 1.0)),
      weight_of_latest_(std::min(control_period / limits_.short_memory, 1.0)) {}

std::span<const double> PaceOfOthers::steps_lost(std::span<const maps::PredictedObstacle* const> others,
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
    if (path.distance < field.options().outside.distance && path.speed >= limits_.slowest_path &&
        std::abs(wrap_angle(place.yaw - double(path.yaw))) < CarScale::same_way) {
      const double share = std::hypot(to.x - from.x, to.y - from.y) / other.interval / double(path.speed);
      // A car that speeds up, as after a start, has not shown its pace yet.
      if (share < pace.latest + limits_.rising) pace.share += weight_of_new_ * (share - pace.share);
      pace.latest += weight_of_latest_ * (share - pace.latest);
    }
    lost_[i] =
        follows(own, place) ? steps_behind_ * std::clamp(1 - pace.share, 0.0, limits_.largest_share) : 0;
  }
  return {lost_.data(), others.size()};
}

bool PaceOfOthers::follows(const maps::Pose& own, const maps::Pose& other) const noexcept {
  const maps::Point place = maps::inverse_transform(other, {own.x, own.y});
  return place.x > -limits_.behind && place.x < limits_.ahead && std::abs(place.y) < limits_.beside &&
         std::abs(wrap_angle(own.yaw - other.yaw)) < CarScale::same_way;
}

/// Returns the memory of this car. A new car replaces the one that was seen longest ago.
PaceOfOthers::Pace& PaceOfOthers::pace_of(int id) noexcept {
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

}  // namespace slalom::vehicle::detail
