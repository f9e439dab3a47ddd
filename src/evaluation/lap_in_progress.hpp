#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "evaluation/driver/driver_stack.hpp"
#include "evaluation/overtaking/overtaking_meter.hpp"
#include "slalom/evaluation/lap_runner.hpp"
#include "slalom/sim/collision_log.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/racing_opponent.hpp"

namespace slalom::evaluation {

/// Everything that changes while a lap is driven.
struct LapRunner::LapInProgress {
  LapInProgress(const sim::WorldOptions& options, const Environment& environment,
                const std::vector<maps::ReferencePoint>& path, const vehicle::Configuration& configuration)
      : world(options, environment.track), meter(path, configuration.vehicle) {}

  /// Sums over control steps, for the means of the result.
  struct Sums {
    double state_cost = 0, collision_cost = 0, paper_model_cost = 0, driven_cost = 0;
    double input_error = 0, speed = 0, path_distance = 0;
    double variance = 0, effective_samples = 0;  ///< over `solves`
    int solves = 0;
  };

  sim::World world;
  SequenceCostMeter meter;
  std::optional<DriverStack> driver;            ///< of the first car, once the world has been reset
  std::unique_ptr<OvertakingMeter> overtaking;  ///< null without opponents
  sim::CollisionLog log;
  LapResult result;
  Sums sums;
  /// With which drivers the opponents began. They may not be those of the runner that drives the car now.
  std::vector<std::shared_ptr<const LapRunner>> planning_opponents;
  /// Drivers of the opponents: along the path, by the states of all cars, or with sensors and planner.
  std::vector<std::variant<sim::PurePursuit, sim::RacingOpponent, DriverStack>> opponents;
  std::vector<Command> commands{1};  ///< of all cars
};

}  // namespace slalom::evaluation
