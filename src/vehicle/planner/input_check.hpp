#pragma once

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/planner/car_estimator.hpp"

namespace slalom::vehicle::detail {

/// Whether odometry is a number and as large as that of a car may be.
inline bool plausible(const Odometry& o) {
  return std::abs(o.pose.x) <= Odometry::furthest && std::abs(o.pose.y) <= Odometry::furthest &&
         std::abs(o.pose.yaw) <= Odometry::max_yaw && std::abs(o.speed) <= Odometry::fastest;
}

/// Throws std::invalid_argument unless a planner can be made of these parts.
inline void check_parts(const PlannerOptions& options, const VehicleModel* model,
                        std::span<const maps::ReferencePoint> path, const Solver* solver) {
  validate_options(options, "planner");
  if (!model) throw std::invalid_argument("planner: model must not be null");
  if (!solver) throw std::invalid_argument("planner: solver must not be null");
  if (delay_of(options, model->traits()) > 32 * options.control_period) {
    throw std::invalid_argument(
        "planner.latency: together with vehicle.dead_time must be at most 32 control periods");
  }
  if (solver->inputs() != model->inputs()) {
    throw std::invalid_argument("planner: solver has " + std::to_string(solver->inputs()) +
                                " inputs per step, must have " + std::to_string(model->inputs()) +
                                ", like the vehicle model");
  }
  maps::check_reference_path(path);
}

}  // namespace slalom::vehicle::detail
