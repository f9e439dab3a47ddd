#pragma once

#include <utility>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::nodes {

/// Where a node learns of the moving objects around its robot.
enum class OthersFrom {
  none,   ///< nowhere: they are obstacles where they are
  scan,   ///< from its scans, in which it tracks them
  topic,  ///< from a topic, on which another node sends them
};
inline const char* const* enum_names(OthersFrom) {
  static constexpr const char* const names[] = {"none", "scan", "topic", nullptr};
  return names;
}

/// Tracks and predicts the moving objects around a robot. After construction nothing allocates or throws.
class OthersWatch {
 public:
  OthersWatch(tracking::ObjectTracker tracker, tracking::Predictor predictor)
      : tracker_(std::move(tracker)), predictor_(std::move(predictor)) {
    turned_.resize(static_cast<std::size_t>(tracker_.options().max_beams));
    objects_.reserve(most);
  }

  /// Tracks the objects in a scan. One all around may begin at any angle.
  void see(tracking::TrackerInput input) noexcept {
    maps::LaserScanView& scan = input.scan;
    const auto count = static_cast<long>(scan.ranges.size());
    const bool turns = scan.angle_increment > 0 && scan.angle_increment * count > 1.98 * std::numbers::pi;
    if (turns &&
        scan.ranges.size() <= turned_.size()) {  // the tracker sees nothing across the ends of a scan
      const long first = saturate_cast<long>(
          std::round((-std::numbers::pi - maps::wrap_angle(scan.angle_min)) / scan.angle_increment));
      std::rotate_copy(scan.ranges.begin(), scan.ranges.begin() + (first % count + count) % count,
                       scan.ranges.end(), turned_.begin());
      scan.ranges = std::span(turned_).first(scan.ranges.size());
      scan.angle_min += scan.angle_increment * static_cast<double>(first);
    }
    hear(tracker_.update(input).objects, input.stamp);
  }
  /// Takes the objects that another node tracks, as they are at `stamp` (s); at most 32.
  void hear(std::span<const tracking::TrackedObject> objects, double stamp) noexcept {
    objects_.assign(objects.begin(), objects.begin() + std::min(objects.size(), most));
    heard_ = moved_to_ = stamp;
  }
  /// Predicts the objects of the last call of either from a time (s) on; none if that is more than a second
  /// later. Valid until the next call.
  std::span<const maps::PredictedObstacle> predict(double now) noexcept {
    if (!(std::abs(now - heard_) < 1)) return {};
    const double passed = now - std::exchange(moved_to_, now);
    for (tracking::TrackedObject& each : objects_) {
      each.pose.x += each.speed * passed * std::cos(each.pose.yaw);
      each.pose.y += each.speed * passed * std::sin(each.pose.yaw);
      each.pose.yaw += each.yaw_rate * passed;
    }
    return predictor_.update(objects_, now);
  }

 private:
  static constexpr std::size_t most = 32;

  tracking::ObjectTracker tracker_;
  tracking::Predictor predictor_;
  std::vector<float> turned_;                     ///< m, the ranges of a scan from behind the robot on
  std::vector<tracking::TrackedObject> objects_;  ///< as they are at `moved_to_`
  double heard_ = -1e9, moved_to_ = 0;            ///< s
};

}  // namespace slalom::nodes
