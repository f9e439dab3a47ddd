#pragma once

namespace slalom::vehicle::published {

/// What the planner does as the published program of Honda et al. (ICRA 2024) does it.
struct PlannerOptions {
  bool maps = false;  ///< cost map and reference field as in the paper's program

  /// Whether all values are equal.
  bool operator==(const PlannerOptions&) const = default;
};

}  // namespace slalom::vehicle::published
