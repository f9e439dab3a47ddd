#pragma once

#include <string>

#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::view {

/// Rollout steps of a solve that a client may ask for; about 25 to 150 ms on one core.
inline constexpr double max_rollout_steps = 5e6;

/// About how many rollout steps a solve of a method takes: those of its samples, in all iterations, and those
/// that move guides or particles.
double rollout_steps(const vehicle::Configuration& configuration, const std::string& method);

/// Throws std::invalid_argument if a solve takes more than `max_rollout_steps`: one client could otherwise
/// stop the drive of all others.
void check_work(const vehicle::Configuration& configuration, const std::string& method);

}  // namespace slalom::view
