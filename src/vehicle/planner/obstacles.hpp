#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/planner/cars_behind.hpp"
#include "vehicle/planner/map_options.hpp"
#include "vehicle/planner/obstacle_memory.hpp"
#include "vehicle/planner/pace_of_others.hpp"

namespace slalom::vehicle::detail {

/// The obstacles of the planner: maps of the scans, and predictions of other cars.
class Obstacles {
 public:
  /// Plans have `horizon` steps, and maps reach `reach` (m).
  Obstacles(const PlannerOptions& options, const VehicleTraits& traits, int horizon, double reach)
      : laser_{options.laser_x, options.laser_y, options.laser_yaw},
        control_period_(options.control_period),
        time_step_(traits.time_step),
        delay_(options.latency + traits.dead_time),
        has_clearance_(traits.obstacles.map == ObstacleMap::clearance),
        slips_(traits.tyres.friction > 0),
        meets_others_(options.predict_others && traits.obstacles.meets_others),
        cost_map_(cost_map_options(options, traits)),
        clearance_map_(clearance_options(options, traits, reach)),
        memory_(map_scale(options)),
        others_(moving_options(options, traits.body), horizon),
        behind_(traits.wheelbase),
        pace_(options.time_behind / traits.time_step, options.control_period),
        ranges_(meets_others_ ? static_cast<std::size_t>(cost_map_.options().max_beams) : 0) {}

  /// Takes the scan and the other inputs of an update. Readings of predicted cars are left out of the maps.
  /// `placed` tells whether the odometry can be used.
  maps::ScanReport update(const PlannerInput& input, bool placed) noexcept {
    const bool predicts = meets_others_ && placed;
    const auto others = predicts ? behind_.giving_way(input.others, input.odometry.pose)
                                 : std::span<const maps::PredictedObstacle>{};
    others_.update(others, {input.odometry.pose.x, input.odometry.pose.y}, delay_, time_step_);
    const maps::LaserScanView scan = others_.view().empty() ? input.scan : without_others(input);
    if (!has_clearance_) {
      const maps::ScanReport report = cost_map_.update(scan);
      cost_map_.add_points(input.obstacles);
      return report;
    }
    const maps::ScanReport report = cost_map_.read(scan);
    clearance_map_.clear();
    clearance_map_.add(cost_map_.points());
    clearance_map_.add(input.obstacles);
    if (slips_ && report.accepted && placed) {
      clearance_map_.add(memory_.blind_points(input.odometry.pose, laser_, input.scan));
      memory_.remember(cost_map_.points(), input.odometry.pose, control_period_);
    }
    return report;
  }

  /// Adds obstacles that no scan shows (m, frame of the robot). Call it after `update`.
  void add(std::span<const maps::Point> points) noexcept { clearance_map_.add(points); }

  /// Charges plans that end behind a slower car for the time that is lost there. Call it after `update`.
  /// `own`, the pose of the car, and the field are relative to `origin` (m, map frame).
  void charge_time_behind(const maps::ReferenceField& field, const maps::Point& origin,
                          const maps::Pose& own) noexcept {
    if (slips_ && !others_.view().empty())
      others_.set_following_costs(pace_.steps_lost(others_.taken(), field, origin, own));
  }

  /// Forgets all obstacles.
  void reset() noexcept {
    pace_.reset();
    memory_.reset();
    cost_map_.clear();
    others_.clear();
  }

  /// Returns the maps for rollouts: this reference field and the obstacles seen from `robot`. All are
  /// relative to `origin` (m, map frame).
  VehicleMaps seen_from(const maps::Pose& robot, const GridView<4>& reference,
                        const maps::Point& origin) const noexcept {
    return {reference, has_clearance_ ? clearance_map_.view() : cost_map_.view(), robot,
            others_.view().relative_to(origin)};
  }

  /// Whether a moving car is close ahead of a car at `own`, which is relative to `origin` (m, map frame).
  bool one_drives_ahead(const maps::Pose& own, const maps::Point& origin) const noexcept {
    const auto taken = others_.taken();
    return std::any_of(taken.begin(), taken.end(), [&](const maps::PredictedObstacle* each) {
      const maps::Pose& now = each->poses.front().pose;
      const maps::Point place = maps::inverse_transform(own, {now.x - origin.x, now.y - origin.y});
      return place.x > 0 && place.x < close_ahead && std::abs(place.y) < close_beside;
    });
  }

  const maps::LocalCostMap& cost_map() const noexcept { return cost_map_; }
  const maps::ClearanceMap& clearance_map() const noexcept { return clearance_map_; }

 private:
  static constexpr double tracking_error = 0.12;  ///< m, between a reading of a car and its predicted box
  /// Least margins (m) to other cars, whose predictions are less certain than walls.
  static constexpr double least_margin = 0.05, least_soft_margin = 0.25;
  /// m from the rear axle; the own car waits for a car that is nearer.
  static constexpr double close_ahead = 3, close_beside = 1;

  static maps::MovingObstacleOptions moving_options(const PlannerOptions& options, const BodyOptions& body) {
    maps::MovingObstacleOptions made;
    made.front = body.front;
    made.rear = body.rear;
    made.width = body.width;
    made.margin = std::max(body.margin, least_margin);
    made.soft_margin = std::max(body.soft_margin, least_soft_margin);
    made.soft_cost = body.soft_cost;
    made.max_probability = options.collision_probability;
    return made;
  }

  /// Returns the scan without the readings that end on other cars as they are now.
  maps::LaserScanView without_others(const PlannerInput& input) noexcept {
    maps::LaserScanView scan = input.scan;
    // A scan with clockwise or too many beams keeps its readings: the cars are obstacles where they are, too.
    if (scan.ranges.size() > ranges_.size() || !(scan.angle_increment > 0)) return scan;
    std::copy(scan.ranges.begin(), scan.ranges.end(), ranges_.begin());
    const maps::Point at = maps::transform(input.odometry.pose, {laser_.x, laser_.y});
    const maps::Pose sensor{at.x, at.y, input.odometry.pose.yaw + laser_.yaw};
    const std::span<float> ranges(ranges_.data(), scan.ranges.size());
    for (const maps::PredictedObstacle* const other : others_.taken())
      maps::drop_readings_of(*other, tracking_error, sensor, scan, ranges);
    scan.ranges = ranges;
    return scan;
  }

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
