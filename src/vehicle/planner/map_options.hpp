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

/// Returns the path with the speeds that the options allow; if plans seek the shortest time, all are
/// `max_speed`.
std::vector<maps::ReferencePoint> limited_path(std::span<const maps::ReferencePoint> path,
                                               const PlannerOptions& options, const VehicleTraits& traits);

/// Returns the factor by which cells and lengths of maps are larger than those of a 1/10-scale car.
double map_scale(const PlannerOptions& options);

/// Returns the time (s) in which a car at the path's highest speed drives its stopping distance, or 0 if
/// plans need not be able to stop.
double stopping_time(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
                     const VehicleTraits& traits);

/// Returns the distance (m) that the car can drive in this time (s).
double plan_reach(std::span<const maps::ReferencePoint> path, const PlannerOptions& options,
                  const VehicleTraits& traits, double duration);

maps::LocalCostMapOptions cost_map_options(const PlannerOptions& options, const VehicleTraits& traits);

/// Options of the map of clearances. For a car with slipping tyres the map reaches as far as a plan (`reach`,
/// m).
maps::ClearanceMapOptions clearance_options(const PlannerOptions& options, const VehicleTraits& traits,
                                            double reach);

/// Options of the reference field. For a car with slipping tyres it reaches as far as a plan (`reach`, m).
maps::ReferenceFieldOptions field_options(const PlannerOptions& options, const VehicleTraits& traits,
                                          double reach);

}  // namespace slalom::vehicle::detail
