#pragma once

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "slalom/navigation/navigator.hpp"

namespace slalom_nav2 {

/// A term of one's own in the cost of plans: a plugin of this class, named by the parameter `cost_plugins`.
class CostTerm {
 public:
  virtual ~CostTerm() = default;
  /// Reads parameters, whose names begin with `prefix`. May throw std::exception.
  virtual void configure(rclcpp_lifecycle::LifecycleNode& node, const std::string& prefix) = 0;
  /// Adds the cost per second of each state (slalom::navigation::StateCost). Must not throw.
  virtual void add(const slalom::navigation::RolloutStates& states, std::span<double> costs) = 0;
};

}  // namespace slalom_nav2
