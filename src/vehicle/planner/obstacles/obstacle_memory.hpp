#pragma once

#include <array>
#include <span>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/pose.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

/// The numbers of ObstacleMemory.
struct MemoryLimits {
  CarScale car;
  double interval = 0.2 * car.speed;  ///< s between scans that are kept
  double apart = 0.15 * car.length;   ///< m from the last scan that was kept
  double turned = 0.15;               ///< rad from it
  double reach = 4 * car.length;      ///< m; points that are further away are not kept
};

/// Remembers the obstacle points of the last scans, in the frame of the odometry. Where the scan does not
/// reach, old points still count, so a reversing car knows the obstacles behind it. Only scans from different
/// places are kept, so a car that stands or shuffles forgets nothing.
class ObstacleMemory {
 public:
  explicit ObstacleMemory(const CarScale& car);

  void reset() noexcept;

  /// Remembers points (robot's frame, m) of the scan at `pose`. Call it once per control period (s).
  void remember(std::span<const maps::ScanPoint> seen, const maps::Pose& pose, double period) noexcept;

  /// Returns the remembered points outside of the scan `view`, in the robot's frame at `pose`. `laser` is the
  /// pose of the laser in the robot's frame.
  std::span<const maps::Point> blind_points(const maps::Pose& pose, const maps::Pose& laser,
                                            const maps::LaserScanView& view) noexcept;

 private:
  static constexpr std::size_t scans = 24, max_points = 160;  ///< scans that are kept, and points of each

  struct Scan {
    std::array<maps::Point, max_points> points;  ///< map frame
    std::size_t count = 0;
  };
  MemoryLimits limits_;
  std::array<Scan, scans> scans_{};
  std::size_t next_ = 0;
  double age_ = 0;   ///< s, of the scan that was kept last
  maps::Pose last_;  ///< pose of the scan that was kept last
  bool is_empty_ = true;
  ReservedVector<maps::Point> blind_;
};

}  // namespace slalom::vehicle::detail
