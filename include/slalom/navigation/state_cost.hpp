#pragma once

#include <functional>
#include <span>

namespace slalom::navigation {

/// The states of rollouts at one step, an entry for each rollout.
struct RolloutStates {
  int step;                         ///< from 0
  std::span<const double> x, y;     ///< m, map frame
  std::span<const double> yaw;      ///< rad, not wrapped
  std::span<const double> forward;  ///< m/s, driven in this step
  std::span<const double> left;     ///< m/s, driven in this step
  std::span<const double> turn;     ///< rad/s, driven in this step
};

/// A term of the cost of plans: adds the cost per second of each state to `costs`, which is an integral over
/// time like the other terms (CostOptions). It must not throw, and is called from one thread at a time.
using StateCost = std::function<void(const RolloutStates& states, std::span<double> costs)>;

}  // namespace slalom::navigation
