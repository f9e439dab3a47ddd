#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/planner/planner_options.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

/// The part of the path ahead that a scan shows.
struct PathInSight {
  static constexpr double all = std::numeric_limits<double>::infinity();
  double way = all;       ///< m along the path, to the first place that an obstacle beside the path hides
  double obstacle = all;  ///< m along the path, to the first obstacle on it
};

/// The numbers of Sight.
struct SightLimits {
  CarScale car;
  double too_near = 0.4 * car.length;  ///< m from the laser; nearer places count as seen
  double leeway = 0.45 * car.length;   ///< m; how far beside the path the car may drive unseen
  double gap = 0.1 * car.length;       ///< m, from the car to what it stops before
  double least_speed = 1 * car.speed;  ///< m/s: at this speed a car sees around any corner in time
};

/// Computes how far the path ahead is in sight. A car that cannot stop within this distance cannot avoid an
/// obstacle behind the next corner.
class Sight {
 public:
  /// Looks along this path, up to `reach` (m) ahead. The options give the pose of the laser. An obstacle that
  /// the body of the car would touch counts as on the path.
  Sight(std::span<const maps::ReferencePoint> path, bool closed, double reach, const PlannerOptions& options,
        const BodyOptions& body);

  /// Looks from a pose in the frame of the path; `nearest` is the point of the path nearest to it. A beam
  /// without a reading shows everything. Obstacles on the path hide nothing, since a plan that passes them
  /// sees the path behind them in time.
  PathInSight look(const maps::LaserScanView& scan, const maps::Pose& pose, int nearest) noexcept;

  /// Points (m, frame of the car) beside the hidden part of the path that are hidden, too. Only the path
  /// itself is known to be free there: a car that leaves it for a shorter way may meet a wall.
  std::span<const maps::Point> unknown() const noexcept { return {unknown_.data(), unknown_count_}; }

  /// The highest speed (m/s, > 0) at which the car stops within `way` (m) with `sight_deceleration`.
  double stopping_speed(double way) const noexcept;

 private:
  std::optional<maps::Point> hidden_by(const maps::LaserScanView& scan,
                                       const maps::Point& place) const noexcept;
  void add_unknown(const maps::LaserScanView& scan, const maps::Pose& pose, std::size_t at) noexcept;
  bool on_path(const maps::Point& point, std::size_t from, std::size_t to) const noexcept;
  bool advance(std::size_t& at) const noexcept;

  std::vector<maps::ReferencePoint> path_;
  bool closed_;
  SightLimits limits_;
  double reach_, half_width_;            ///< m
  double front_, deceleration_, delay_;  ///< m, m/s^2, s
  maps::Pose laser_;
  std::vector<maps::Point> unknown_;
  std::size_t unknown_count_ = 0;
};

}  // namespace slalom::vehicle::detail
