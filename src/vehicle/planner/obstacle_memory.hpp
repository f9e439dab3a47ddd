#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

/// The obstacle points of the last seconds in the frame of the odometry, so that a car that reverses knows
/// what it has passed: where the scan does not reach, they are obstacles still.
class ObstacleMemory {
 public:
  ObstacleMemory() { blind_.reserve(scans * max_points); }

  void reset() noexcept {
    for (Scan& scan : scans_) scan.count = 0;
    age_ = interval;
  }

  /// Keeps points (robot's frame, m) of the scan at `pose`; to be called once a control period (s).
  void remember(std::span<const maps::ScanPoint> seen, const maps::Pose& pose, double period) noexcept {
    age_ += period;
    if (age_ < interval) return;
    age_ = 0;
    Scan& scan = scans_[next_];
    next_ = (next_ + 1) % scans;
    scan.count = 0;
    const std::size_t stride = seen.size() / max_points + 1;
    for (std::size_t i = 0; i < seen.size() && scan.count < max_points; i += stride) {
      const maps::Point point{static_cast<double>(seen[i].x), static_cast<double>(seen[i].y)};
      if (point.x * point.x + point.y * point.y < reach * reach)
        scan.points[scan.count++] = maps::transform(pose, point);
    }
  }

  /// The points that the scan of a laser there, robot's frame, does not reach, in the robot's frame at
  /// `pose`.
  std::span<const maps::Point> blind_points(const maps::Pose& pose, const maps::Pose& laser,
                                            const maps::LaserScanView& view) noexcept {
    blind_.clear();
    const double first = view.angle_min,
                 last = view.angle_min + view.angle_increment * (static_cast<double>(view.ranges.size()) - 1);
    for (const Scan& scan : scans_) {
      for (std::size_t i = 0; i < scan.count; ++i) {
        const maps::Point point = maps::inverse_transform(pose, scan.points[i]);
        const double angle = maps::wrap_angle(std::atan2(point.y - laser.y, point.x - laser.x) - laser.yaw);
        const bool near = std::abs(point.x) < reach && std::abs(point.y) < reach;
        if (near && (angle < first || angle > last)) blind_.push_back(point);
      }
    }
    return blind_;
  }

 private:
  static constexpr std::size_t scans = 24, max_points = 160;
  static constexpr double interval = 0.2;  ///< s between scans that are kept
  static constexpr double reach = 4;       ///< m, of points that are kept

  struct Scan {
    std::array<maps::Point, max_points> points;  ///< map frame
    std::size_t count = 0;
  };
  std::array<Scan, scans> scans_{};
  std::size_t next_ = 0;
  double age_ = interval;
  std::vector<maps::Point> blind_;
};

}  // namespace slalom::vehicle::detail
