#pragma once

#include <span>

#include "slalom/maps/pose.hpp"

namespace slalom::navigation::detail {

/// Replaces the yaws of a path but the last by those of the robot on the way to the next pose: the direction
/// of that way, or its opposite where the robot reverses. It reverses where the given yaws say so; they count
/// if each is within 60 degrees of the direction or its opposite, on every way. Otherwise it drives forward;
/// a base that cannot turn on the spot (`reverses_at_cusps`) changes its direction of travel at cusps.
void set_yaws(std::span<maps::Pose> path, bool reverses_at_cusps) noexcept;

}  // namespace slalom::navigation::detail
