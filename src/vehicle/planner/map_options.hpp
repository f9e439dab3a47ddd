#pragma once

#include <span>
#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"
#include "slalom/vehicle/planner/planner_options.hpp"

/// The options of the planner's maps, and its path.
namespace slalom::vehicle::detail {

/// Returns the highest speed (m/s) of a plan.
double fastest(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
               const VehicleTraits& traits);

/// Returns the factor by which cells and lengths of maps are larger than those of a 1/10-scale car.
double map_scale(const PlannerOptions& options);

/// Returns the time (s) of the stopping distance at the path's highest speed; 0 if plans need not stop.
double stopping_time(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
                     const VehicleTraits& traits);

/// Returns the distance (m) that the car can drive in this time (s).
double plan_reach(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
                  const VehicleTraits& traits, double duration);

/// Returns the options of the map of costs, on which a box is checked for collisions.
maps::LocalCostMapOptions cost_map_options(const PlannerOptions& options, const VehicleTraits& traits);

/// Options of the map of clearances. With slipping tyres it reaches as far as a plan (`reach`, m).
maps::ClearanceMapOptions clearance_options(const PlannerOptions& options, const VehicleTraits& traits,
                                            double reach);

/// Options of the reference field. With slipping tyres it reaches as far as a plan (`reach`, m).
maps::ReferenceFieldOptions field_options(const PlannerOptions& options, const VehicleTraits& traits,
                                          double reach);

/// Returns the path with the speeds that the options allow; if plans seek the shortest time, all are
/// `max_speed`. An open path ends with a stop, except in the published program.
std::vector<maps::ReferencePoint> limited_path(std::span<const maps::ReferencePoint> path,
                                               const PlannerOptions& options, const VehicleTraits& traits);

}  // namespace slalom::vehicle::detail
