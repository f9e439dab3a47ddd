#pragma once

#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/planner/car_scale.hpp"
#include "vehicle/planner/obstacles/cars_behind.hpp"
#include "vehicle/planner/obstacles/obstacle_memory.hpp"
#include "vehicle/planner/obstacles/pace_of_others.hpp"

namespace slalom::vehicle::detail {

/// The margins (m) to other cars, whose predictions are less certain than walls.
struct ObstacleMargins {
  CarScale car;
  double least = 0.05 * car.length;       ///< m, margin to other cars at least
  double least_soft = 0.25 * car.length;  ///< m, soft margin to other cars at least
  double close_ahead = 3 * car.length;    ///< m ahead of the rear axle; for a nearer car the own one waits
  double close_beside = 1 * car.length;   ///< m beside it
  double standing = 0.3 * car.speed;      ///< m/s; a slower car stands
};

/// The obstacles of the planner: maps of the scans, and predictions of other cars.
class Obstacles {
 public:
  /// Plans have `horizon` steps, and maps reach `reach` (m).
  Obstacles(const PlannerOptions& options, const VehicleTraits& traits, int horizon, double reach);

  /// Takes the scan and the other inputs of an update. Readings of predicted cars that drive are left out of
  /// the maps. `placed` tells whether the odometry can be used.
  maps::ScanReport update(const PlannerInput& input, bool placed) noexcept;

  /// Adds obstacles that no scan shows (m, frame of the robot). Call it after `update`.
  void add(std::span<const maps::Point> points) noexcept { clearance_map_.add(points); }

  /// Charges plans that end behind a slower car for the time that is lost there. Call it after `update`.
  /// `own`, the pose of the car, and the field are relative to `origin` (m, map frame).
  void charge_time_behind(const maps::ReferenceField& field, const maps::Point& origin,
                          const maps::Pose& own) noexcept;

  /// Forgets all obstacles.
  void reset() noexcept;

  /// Returns the maps for rollouts: this reference field and the obstacles seen from `robot`. All are
  /// relative to `origin` (m, map frame).
  VehicleMaps seen_from(const maps::Pose& robot, const GridView<4>& reference,
                        const maps::Point& origin) const noexcept;

  /// Whether a moving car is close ahead of a car at `own`, which is relative to `origin` (m, map frame).
  bool one_drives_ahead(const maps::Pose& own, const maps::Point& origin) const noexcept;

  const maps::LocalCostMap& cost_map() const noexcept { return cost_map_; }
  const maps::ClearanceMap& clearance_map() const noexcept { return clearance_map_; }

 private:
  maps::LaserScanView without_others(const PlannerInput& input) noexcept;

  ObstacleMargins margins_;
  maps::Pose laser_;
  double control_period_, time_step_, delay_;  ///< s
  bool has_clearance_, slips_, meets_others_;
  maps::LocalCostMap cost_map_;
  maps::ClearanceMap clearance_map_;
  ObstacleMemory memory_;
  maps::MovingObstacles others_;
  CarsBehind behind_;
  PaceOfOthers pace_;
  std::vector<float> ranges_;  ///< ranges of a scan without the readings of other cars
};

}  // namespace slalom::vehicle::detail
