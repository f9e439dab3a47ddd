#include "vehicle/planner/map_options.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/vehicle/course/course_check.hpp"

namespace slalom::vehicle::detail {
namespace {

/// The share of the largest deceleration with which the car stops at the end of an open path.
constexpr double stopping_share = 0.5;

/// Lowers the speeds of an open path, so that the car stops at its end.
void stop_at_end(std::vector<maps::ReferencePoint>& path, double deceleration) {
  std::vector<maps::Point> points;
  for (const maps::ReferencePoint& point : path) points.push_back({point.x, point.y});
  const PathGeometry geometry = path_geometry(points);
  if (geometry.closed) return;
  path.back().speed = 0;
  for (std::size_t i = path.size() - 1; i-- > 0;) {
    const double next = path[i + 1].speed;
    path[i].speed = std::min(path[i].speed, std::sqrt(next * next + 2 * deceleration * geometry.step[i]));
  }
}

}  // namespace

double fastest(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
               const VehicleTraits& traits) {
  if (traits.tyres.seeks_lap_time) return options.max_speed;
  double speed = 0;
  for (const maps::ReferencePoint& point : path) speed = std::max(speed, point.speed);
  return std::min(speed, options.max_speed);
}

double map_scale(const PlannerOptions& options) {
  return options.map_resolution / PlannerOptions{}.map_resolution;
}

double stopping_time(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
                     const VehicleTraits& traits) {
  if (!(traits.tyres.stopping_deceleration > 0)) return 0;
  return fastest(path, options, traits) / (2 * traits.tyres.stopping_deceleration);
}

double plan_reach(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
                  const VehicleTraits& traits, double duration) {
  constexpr double least = 6, most = 30;  // m, reach of the maps
  const double scale = map_scale(options);
  return std::clamp(fastest(path, options, traits) * duration + 1.5, scale * least, scale * most);
}

maps::LocalCostMapOptions cost_map_options(const PlannerOptions& options, const VehicleTraits& traits) {
  maps::LocalCostMapOptions made;
  if (options.published.maps) {
    made = maps::published_cost_map();
  } else {
    const double scale = map_scale(options);
    for (double* const length : {&made.resolution, &made.length_x, &made.length_y, &made.center_x})
      *length *= scale;
    const BodyOptions& body = traits.body;
    made.footprint = {body.front, body.rear, body.width / 2, body.width / 2};
    made.margin = body.margin;
    made.soft_margin = body.soft_margin;
    made.soft = body.soft_cost;
  }
  made.laser = {options.laser_x, options.laser_y, options.laser_yaw};
  made.outside = -1;  // so that the problem can tell "off the map" from "occupied"
  return made;
}

maps::ClearanceMapOptions clearance_options(const PlannerOptions& options, const VehicleTraits& traits,
                                            double reach) {
  const double scale = map_scale(options), behind = 3 * scale, widest = 8 * scale;  // m
  maps::ClearanceMapOptions made;
  made.resolution *= scale;
  if (traits.obstacles.map == ObstacleMap::clearance) made.reach = traits.obstacles.reach;
  if (traits.tyres.friction > 0) {
    made.length_x = reach + behind;
    made.center_x = 0.5 * (reach - behind);
    made.length_y = 2 * std::min(reach, widest);
  }
  return made;
}

maps::ReferenceFieldOptions field_options(const PlannerOptions& options, const VehicleTraits& traits,
                                          double reach) {
  if (options.published.maps) return maps::published_reference_field();
  maps::ReferenceFieldOptions made;
  made.resolution *= map_scale(options);
  made.spacing *= map_scale(options);
  if (traits.tyres.friction > 0) {
    made.length_x = made.length_y = 2 * reach + 1;
    made.spacing = std::max(made.spacing, (reach + 1) / 200);
    made.points = saturate_cast<int>((reach + 1) / made.spacing);
  }
  return made;
}

std::vector<maps::ReferencePoint> limited_path(std::span<const maps::ReferencePoint> path,
                                               const PlannerOptions& options, const VehicleTraits& traits) {
  std::vector<maps::ReferencePoint> made(path.begin(), path.end());
  for (auto& point : made)
    point.speed = traits.tyres.seeks_lap_time ? options.max_speed : std::min(point.speed, options.max_speed);
  if (options.profile_friction > 0)
    make_feasible(made, grip_limits(options.profile_friction, options.max_speed, traits.max_acceleration,
                                    traits.max_deceleration));
  if (!options.published.maps) stop_at_end(made, stopping_share * traits.max_deceleration);
  return made;
}

}  // namespace slalom::vehicle::detail
