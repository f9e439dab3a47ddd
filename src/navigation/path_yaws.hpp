#pragma once

#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/base.hpp"

namespace slalom::navigation::detail {

/// Replaces the yaws of a path but the last by those of the robot on the way to the next pose: the direction
/// of that way, or its opposite where the robot reverses. It reverses where the given yaws say so; they count
/// if they are not all the same, and each is within 60 degrees of the direction or its opposite, on every
/// way. Otherwise it drives forward; an Ackermann base changes its direction of travel at cusps. A base that
/// cannot reverse drives forward everywhere.
void set_yaws(std::span<maps::Pose> path, const BaseOptions& base) noexcept;

/// Sets the straight path from the robot to the goal, which it drives in reverse if it faces away and can.
/// The path has room for two poses.
void set_straight(std::vector<maps::Pose>& path, const maps::Pose& robot, const maps::Pose& goal,
                  const BaseOptions& base) noexcept;

}  // namespace slalom::navigation::detail
