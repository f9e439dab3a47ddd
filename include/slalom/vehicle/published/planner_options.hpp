#pragma once

namespace slalom::vehicle::published {

/// Parts of the planner that follow the published program of Honda et al. (ICRA 2024).
struct PlannerOptions {
  bool maps = false;  ///< cost map and reference field as in the paper's program
  /// Subtract whole turns from the planned steering angle, and limit only the command to `steer_limit`: the
  /// observer follows the angle itself. It matters where a method leaves its bounds (`clamp_solution`). The
  /// paper's program sends the angle without a limit; its simulator stops the wheels at 0.4189 rad.
  bool wrap_steer = false;

  bool operator==(const PlannerOptions&) const = default;
};

}  // namespace slalom::vehicle::published
