#include "vehicle/planner/obstacles/obstacles.hpp"

#include <algorithm>
#include <cmath>

#include "vehicle/planner/map_options.hpp"

namespace slalom::vehicle::detail {
namespace {

maps::MovingObstacleOptions moving_options(const PlannerOptions& options, const BodyOptions& body,
                                           const ObstacleMargins& margins) {
  return {.front = body.front,
          .rear = body.rear,
          .width = body.width,
          .margin = std::max(body.margin, margins.least),
          .soft_margin = std::max(body.soft_margin, margins.least_soft),
          .soft_cost = body.soft_cost,
          .max_probability = options.collision_probability};
}

/// Whether a car is expected to drive faster than this (m/s).
bool drives(const maps::PredictedObstacle& other, double speed) {
  const int likeliest = other.likeliest();
  const double time = other.interval * static_cast<double>(other.times() - 1);
  const maps::Pose from = other.at(likeliest, 0).pose, to = other.at(likeliest, time).pose;
  return std::hypot(to.x - from.x, to.y - from.y) > speed * time;
}

}  // namespace

Obstacles::Obstacles(const PlannerOptions& options, const VehicleTraits& traits, int horizon, double reach)
    : margins_{CarScale::of(traits.body)},
      laser_{options.laser_x, options.laser_y, options.laser_yaw},
      control_period_(options.control_period),
      time_step_(traits.time_step),
      delay_(options.latency + traits.dead_time),
      has_clearance_(traits.obstacles.map == ObstacleMap::clearance),
      slips_(traits.tyres.friction > 0),
      meets_others_(options.predict_others && traits.obstacles.meets_others),
      cost_map_(cost_map_options(options, traits)),
      clearance_map_(clearance_options(options, traits, reach)),
      memory_(margins_.car),
      others_(moving_options(options, traits.body, margins_), horizon),
      behind_(traits.wheelbase),
      pace_(options.time_behind / traits.time_step, options.control_period, margins_.car),
      ranges_(meets_others_ ? static_cast<std::size_t>(cost_map_.options().max_beams) : 0) {}

maps::ScanReport Obstacles::update(const PlannerInput& input, bool placed) noexcept {
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

void Obstacles::charge_time_behind(const maps::ReferenceField& field, const maps::Point& origin,
                                   const maps::Pose& own) noexcept {
  if (slips_ && !others_.view().empty())
    others_.set_following_costs(pace_.steps_lost(others_.taken(), field, origin, own));
}

void Obstacles::reset() noexcept {
  pace_.reset();
  memory_.reset();
  cost_map_.clear();
  others_.clear();
}

VehicleMaps Obstacles::seen_from(const maps::Pose& robot, const GridView<4>& reference,
                                 const maps::Point& origin) const noexcept {
  return {reference, has_clearance_ ? clearance_map_.view() : cost_map_.view(), robot,
          others_.view().relative_to(origin)};
}

bool Obstacles::one_drives_ahead(const maps::Pose& own, const maps::Point& origin) const noexcept {
  const auto taken = others_.taken();
  return std::any_of(taken.begin(), taken.end(), [&](const maps::PredictedObstacle* each) {
    const maps::Pose& now = each->poses.front().pose;
    const maps::Point place = maps::inverse_transform(own, {now.x - origin.x, now.y - origin.y});
    return drives(*each, margins_.standing) && place.x > 0 && place.x < margins_.close_ahead &&
           std::abs(place.y) < margins_.close_beside;
  });
}

/// Returns the scan without the readings that end on cars that drive: one that stands is an obstacle, too.
maps::LaserScanView Obstacles::without_others(const PlannerInput& input) noexcept {
  maps::LaserScanView scan = input.scan;
  // A scan with clockwise or too many beams keeps its readings: the cars are obstacles where they are, too.
  if (scan.ranges.size() > ranges_.size() || !(scan.angle_increment > 0)) return scan;
  std::copy(scan.ranges.begin(), scan.ranges.end(), ranges_.begin());
  const maps::Point at = maps::transform(input.odometry.pose, {laser_.x, laser_.y});
  const maps::Pose sensor{at.x, at.y, input.odometry.pose.yaw + laser_.yaw};
  const std::span<float> ranges(ranges_.data(), scan.ranges.size());
  for (const maps::PredictedObstacle* const other : others_.taken())
    if (drives(*other, margins_.standing))
      maps::drop_readings_of(*other, SensorErrors::tracked, sensor, scan, ranges);
  scan.ranges = ranges;
  return scan;
}

}  // namespace slalom::vehicle::detail
