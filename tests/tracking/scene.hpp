#pragma once

#include "sim/rooms.hpp"
#include "slalom/sim/lidar.hpp"
#include "slalom/sim/shapes.hpp"
#include "slalom/tracking/object_tracker.hpp"

namespace slalom::tracking::test {

/// Scans of a ring road, 3 m wide, with cars whose places the test gives.
class Scene {
 public:
  static constexpr double period = 0.025;  // s
  static constexpr double length = 0.58, width = 0.31;

  explicit Scene(double noise = 0.02, double dropout = 0.01, std::uint64_t seed = 1)
      : track_(testing::ring_track()),
        lidar_({.beams = 1081, .field_of_view = 4.71238898}),
        noise_(noise),
        dropout_(dropout) {
    random_.reset(seed, 0);
    ranges_.resize(lidar_.padded_beams());
  }

  static sim::Box car(const maps::Pose& pose) { return {pose, length, width}; }

  /// The scan from `sensor`; valid until the next one.
  maps::LaserScanView scan(const maps::Pose& sensor, const std::vector<sim::Box>& cars) {
    lidar_.scan(*track_, sensor, ranges_);
    for (const sim::Box& each : cars) lidar_.cast(sensor, each, ranges_);
    random_.add(ranges_, lidar_.options().beams, noise_, lidar_.options().range_max, dropout_);
    const sim::LidarOptions& o = lidar_.options();
    return {{ranges_.data(), static_cast<std::size_t>(o.beams)},
            o.angle_min(),
            o.angle_increment(),
            0.02,
            o.range_max};
  }

  const maps::OccupancyGrid& map() const { return track_->grid(); }

 private:
  std::shared_ptr<const sim::Track> track_;
  sim::Lidar lidar_;
  sim::NormalNoise random_;
  std::vector<float> ranges_;
  double noise_, dropout_;
};

inline double distance(const maps::Pose& a, const maps::Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The object nearest to a pose; null if none is within 0.5 m.
inline const TrackedObject* nearest(const TrackerOutput& output, const maps::Pose& pose) {
  const TrackedObject* found = nullptr;
  for (const TrackedObject& each : output.objects)
    if (distance(each.pose, pose) < (found ? distance(found->pose, pose) : 0.5)) found = &each;
  return found;
}

}  // namespace slalom::tracking::test
