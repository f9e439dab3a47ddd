#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

/// Remembers the obstacle points of the last scans, in the frame of the odometry. Where the scan does not
/// reach, old points still count, so a reversing car knows the obstacles behind it. Only scans from different
/// places are kept, so a car that stands or shuffles forgets nothing.
class ObstacleMemory {
 public:
  /// The lengths of maps are `scale` times those for a 1/10-scale car.
  explicit ObstacleMemory(double scale) : reach_(4 * scale) { blind_.reserve(scans * max_points); }

  void reset() noexcept {
    for (Scan& scan : scans_) scan.count = 0;
    age_ = interval;
    is_empty_ = true;
  }

  /// Remembers points (robot's frame, m) of the scan at `pose`. Call it once per control period (s).
  void remember(std::span<const maps::ScanPoint> seen, const maps::Pose& pose, double period) noexcept {
    age_ += period;
    const bool elsewhere = is_empty_ || std::hypot(pose.x - last_.x, pose.y - last_.y) > apart ||
                           std::abs(maps::wrap_angle(pose.yaw - last_.yaw)) > turned;
    if (age_ < interval || !elsewhere) return;
    age_ = 0;
    last_ = pose;
    is_empty_ = false;
    Scan& scan = scans_[next_];
    next_ = (next_ + 1) % scans;
    scan.count = 0;
    const std::size_t stride = seen.size() / max_points + 1;
    for (std::size_t i = 0; i < seen.size() && scan.count < max_points; i += stride) {
      const maps::Point point{static_cast<double>(seen[i].x), static_cast<double>(seen[i].y)};
      if (point.x * point.x + point.y * point.y < reach_ * reach_)
        scan.points[scan.count++] = maps::transform(pose, point);
    }
  }

  /// Returns the remembered points outside of the scan `view`, in the robot's frame at `pose`. `laser` is the
  /// pose of the laser in the robot's frame.
  std::span<const maps::Point> blind_points(const maps::Pose& pose, const maps::Pose& laser,
                                            const maps::LaserScanView& view) noexcept {
    blind_.clear();
    const Sector seen(laser, view);
    const double cosine = std::cos(pose.yaw), sine = std::sin(pose.yaw);
    for (const Scan& scan : scans_) {
      for (std::size_t i = 0; i < scan.count; ++i) {
        const double dx = scan.points[i].x - pose.x, dy = scan.points[i].y - pose.y;
        const maps::Point point{cosine * dx + sine * dy, cosine * dy - sine * dx};
        const bool near = std::abs(point.x) < reach_ && std::abs(point.y) < reach_;
        if (near && !seen.contains(point)) blind_.push_back(point);
      }
    }
    return blind_;
  }

 private:
  /// The directions that a scan covers.
  class Sector {
   public:
    Sector(const maps::Pose& laser, const maps::LaserScanView& view)
        : laser_(laser),
          first_(view.angle_min),
          last_(view.angle_min + view.angle_increment * (static_cast<double>(view.ranges.size()) - 1)) {
      if (!(first_ >= -std::numbers::pi && last_ <= std::numbers::pi && first_ <= last_)) return;
      const double middle = 0.5 * (first_ + last_) + laser.yaw;
      along_x_ = std::cos(middle);
      along_y_ = std::sin(middle);
      border_ = std::cos(0.5 * (last_ - first_));
    }

    bool contains(const maps::Point& point) const noexcept {
      const double x = point.x - laser_.x, y = point.y - laser_.y, distance = std::sqrt(x * x + y * y);
      const double inside = along_x_ * x + along_y_ * y - border_ * distance;
      // The angle is computed only at the border, since that takes most of the time.
      if (std::abs(inside) > 1e-6 * distance) return inside > 0;
      const double angle = maps::wrap_angle(std::atan2(y, x) - laser_.yaw);
      return !(angle < first_ || angle > last_);
    }

   private:
    maps::Pose laser_;
    double first_, last_;  ///< rad, from the laser's axis
    /// The middle direction and the cosine of half the sector. With zeros, the angle decides everywhere.
    double along_x_ = 0, along_y_ = 0, border_ = 0;
  };

  static constexpr std::size_t scans = 24, max_points = 160;
  static constexpr double interval = 0.2;               ///< s between scans that are kept
  static constexpr double apart = 0.15, turned = 0.15;  ///< m, rad, from the last scan that was kept

  struct Scan {
    std::array<maps::Point, max_points> points;  ///< map frame
    std::size_t count = 0;
  };
  std::array<Scan, scans> scans_{};
  std::size_t next_ = 0;
  double age_ = interval;
  maps::Pose last_;  ///< pose of the scan that was kept last
  bool is_empty_ = true;
  double reach_;  ///< m; points that are further away are not kept
  ReservedVector<maps::Point> blind_;
};

}  // namespace slalom::vehicle::detail
