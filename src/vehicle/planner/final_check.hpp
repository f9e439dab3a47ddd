#pragma once

#include <algorithm>
#include <cmath>

#include "slalom/core/final_check.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::vehicle::detail {

/// What a command may be.
struct CommandLimits {
  double steer = 0;    ///< rad, to either side
  double fastest = 0;  ///< m/s; where the planner brakes, no more than the car drives
  double slowest = 0;  ///< m/s; negative in reverse
};

/// The last thing that happens to an output before it leaves the planner. Makes the command finite and moves
/// it into the limits: a steering angle that is not a number becomes `wheels` (rad), such a speed 0. Where a
/// cost is not finite, it becomes the largest double, no prediction is returned, and a status that claims a
/// plan becomes `solver_degenerate`. Counts what it changed in `corrections`.
inline void check_output(PlannerOutput& output, const CommandLimits& limits, double wheels) noexcept {
  const auto check = [](double& value, double least, double most, double otherwise) {
    const double valid = std::clamp(std::isfinite(value) ? value : otherwise, least, most);
    const bool changed = valid != value;
    value = valid;
    return static_cast<int>(changed);
  };
  int changed = check(output.command.steer, -limits.steer, limits.steer, std::isfinite(wheels) ? wheels : 0);
  changed += check(output.command.speed, limits.slowest, limits.fastest, 0);
  if (const int costs = check_cost(output.state_cost) + check_cost(output.collision_cost); costs > 0) {
    changed += costs;
    output.predicted = {};
    if (output.status == PlannerStatus::ok || output.status == PlannerStatus::fallback_plan)
      output.status = PlannerStatus::solver_degenerate;
  }
  output.corrections = changed;
}

}  // namespace slalom::vehicle::detail
