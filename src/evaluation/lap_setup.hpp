#pragma once

#include "slalom/evaluation/lap.hpp"
#include "slalom/sim/world.hpp"

/// The parts of a lap that its setup describes.
namespace slalom::evaluation {

/// The options of the world in which a lap is driven.
sim::WorldOptions world_options(const LapSetup& setup);
/// Number of steps of such a world per command.
long long steps_per_command(const LapSetup& setup, const sim::WorldOptions& world) noexcept;
/// The path of the environment with the speeds of the lap's settings.
std::vector<maps::ReferencePoint> path_of(const LapSetup& setup);
/// m before the end of an open path, from where on a car that stands has finished.
constexpr double finish_tolerance = 0.5;
/// Whether the finish of a lap is the end of an open path.
bool ends_with_path(const LapSetup& setup) noexcept;
/// Checks what LapSetup::validate checks, except for the options of drivers. Throws std::invalid_argument.
void check_settings(const LapSetup& setup);
/// Returns the setup with which opponent `index` drives; it must have a planner. Throws std::invalid_argument
/// if the opponent is too slow for its configuration.
LapSetup setup_of_opponent(const LapSetup& setup, int index);
/// Throws std::invalid_argument with this message unless the condition holds.
void require(bool holds, const std::string& message);

}  // namespace slalom::evaluation
