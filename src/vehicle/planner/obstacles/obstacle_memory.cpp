#include "vehicle/planner/obstacles/obstacle_memory.hpp"

#include <cmath>
#include <numbers>

namespace slalom::vehicle::detail {
namespace {

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

}  // namespace

ObstacleMemory::ObstacleMemory(const CarScale& car) : limits_{car} {
  blind_.reserve(scans * max_points);
}

void ObstacleMemory::reset() noexcept {
  for (Scan& scan : scans_) scan.count = 0;
  is_empty_ = true;
}

void ObstacleMemory::remember(std::span<const maps::ScanPoint> seen, const maps::Pose& pose,
                              double period) noexcept {
  age_ += period;
  const bool elsewhere = std::hypot(pose.x - last_.x, pose.y - last_.y) > limits_.apart ||
                         std::abs(maps::wrap_angle(pose.yaw - last_.yaw)) > limits_.turned;
  if (!is_empty_ && (age_ < limits_.interval || !elsewhere)) return;
  age_ = 0;
  last_ = pose;
  is_empty_ = false;
  Scan& scan = scans_[next_];
  next_ = (next_ + 1) % scans;
  scan.count = 0;
  const std::size_t stride = seen.size() / max_points + 1;
  for (std::size_t i = 0; i < seen.size() && scan.count < max_points; i += stride) {
    const maps::Point point{static_cast<double>(seen[i].x), static_cast<double>(seen[i].y)};
    if (point.x * point.x + point.y * point.y < limits_.reach * limits_.reach)
      scan.points[scan.count++] = maps::transform(pose, point);
  }
}

std::span<const maps::Point> ObstacleMemory::blind_points(const maps::Pose& pose, const maps::Pose& laser,
                                                          const maps::LaserScanView& view) noexcept {
  blind_.clear();
  const Sector seen(laser, view);
  const double cosine = std::cos(pose.yaw), sine = std::sin(pose.yaw);
  for (const Scan& scan : scans_) {
    for (std::size_t i = 0; i < scan.count; ++i) {
      const double dx = scan.points[i].x - pose.x, dy = scan.points[i].y - pose.y;
      const maps::Point point{cosine * dx + sine * dy, cosine * dy - sine * dx};
      const bool near = std::abs(point.x) < limits_.reach && std::abs(point.y) < limits_.reach;
      if (near && !seen.contains(point)) blind_.push_back(point);
    }
  }
  return blind_;
}

}  // namespace slalom::vehicle::detail
