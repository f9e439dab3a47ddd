#pragma once

#include <slalom_msgs/msg/tracked_objects.hpp>

#include "conversions.hpp"
#include "slalom/tracking/object_tracker.hpp"

namespace slalom_ros {

/// The objects of a message, moved from its frame to the one in which `frame` is its pose.
inline std::vector<slalom::tracking::TrackedObject> objects_of(const slalom_msgs::msg::TrackedObjects& m,
                                                               const Pose& frame = {}) {
  std::vector<slalom::tracking::TrackedObject> objects;
  for (const auto& each : m.objects) {
    objects.push_back({each.id, nodes::composed(frame, pose_of(each.pose)), each.speed, each.yaw_rate,
                       each.length, each.width});
    for (std::size_t i = 0; i < 25; ++i) objects.back().covariance[i / 5][i % 5] = each.covariance[i];
  }
  return objects;
}

}  // namespace slalom_ros
