#pragma once

#include "slalom/vehicle/model/vehicle_options.hpp"
#include "slalom/vehicle/planner/planner_options.hpp"

namespace slalom::vehicle::published {

/// The published vehicle problem: model, weights and costs, as `configs/published.yaml` has them.
VehicleOptions vehicle_options();

/// The published program's planner, as `configs/published.yaml` has it.
vehicle::PlannerOptions planner_options();

}  // namespace slalom::vehicle::published
