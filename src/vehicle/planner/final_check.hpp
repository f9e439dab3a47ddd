#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/core/final_check.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::vehicle::detail {

/// What a command may be.
struct CommandLimits {
  double steer = 0;    ///< rad, to either side
  double fastest = 0;  ///< m/s; where the planner brakes, no more than the car drives
  double slowest = 0;  ///< m/s; negative in reverse
};

/// Moves a value into a range, or to `otherwise` where it is not finite. Returns whether it was changed, 1 or
/// 0.
inline int check_value(double& value, double least, double most, double otherwise) noexcept {
  const double valid = std::clamp(std::isfinite(value) ? value : otherwise, least, most);
  const bool changed = valid != value;
  value = valid;
  return static_cast<int>(changed);
}

/// Makes a command finite and moves it into the limits: a steering angle that is not a number becomes
/// `wheels` (rad), such a speed 0. Returns the number of values that were changed.
inline int check_command(Command& command, const CommandLimits& limits, double wheels) noexcept {
  return check_value(command.steer, -limits.steer, limits.steer, std::isfinite(wheels) ? wheels : 0) +
         check_value(command.speed, limits.slowest, limits.fastest, 0);
}

/// The last thing that happens to an output before it leaves the planner: check_command; estimates that are
/// not finite become 0. Where a cost is not finite, it becomes the largest double, and no prediction is
/// returned; where an input is not finite, no inputs are either. A status that claims a plan becomes
/// `solver_degenerate` then. Adds what it changed to `corrections`.
inline void check_output(PlannerOutput& output, const CommandLimits& limits, double wheels) noexcept {
  constexpr double most = std::numeric_limits<double>::max();
  output.corrections += check_command(output.command, limits, wheels);
  for (double* const estimate :
       {&output.steer_estimate, &output.speed_estimate, &output.yaw_rate_estimate, &output.slip_estimate})
    output.corrections += check_value(*estimate, -most, most, 0);
  const bool finite =
      std::all_of(output.inputs.begin(), output.inputs.end(), [](float u) { return std::isfinite(u); });
  if (!finite) output.inputs = {};
  const int changed = check_cost(output.state_cost) + check_cost(output.collision_cost) + (finite ? 0 : 1);
  if (changed == 0) return;
  output.corrections += changed;
  output.predicted = {};
  if (output.status == PlannerStatus::ok || output.status == PlannerStatus::fallback_plan)
    output.status = PlannerStatus::solver_degenerate;
}

}  // namespace slalom::vehicle::detail
