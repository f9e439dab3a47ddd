#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "evaluation/hardware_model.hpp"
#include "evaluation/overtaking/overtaking_meter.hpp"
#include "evaluation/tracking/tracking_meter.hpp"
#include "slalom/evaluation/lap_runner.hpp"
#include "slalom/sim/collision_log.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/racing_opponent.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::evaluation {

/// Everything that changes while a lap is driven.
struct LapRunner::LapInProgress {
  LapInProgress(const sim::WorldOptions& options, const Environment& environment,
                const std::vector<maps::ReferencePoint>& path, const vehicle::Configuration& configuration,
                std::unique_ptr<vehicle::Planner> made_planner)
      : world(options, environment.track),
        planner(std::move(made_planner)),
        meter(path, configuration.vehicle) {}

  /// Sums over control steps, for the means of the result.
  struct Sums {
    double state_cost = 0, collision_cost = 0, published_model_cost = 0, driven_cost = 0;
    double input_error = 0, speed = 0, path_distance = 0;
    double variance = 0, effective_samples = 0;  ///< over `solves`
    int solves = 0;
  };

  sim::World world;
  std::unique_ptr<vehicle::Planner> planner;
  SequenceCostMeter meter;
  std::unique_ptr<HardwareModel> hardware;       ///< null where the planner gets exact measurements
  std::unique_ptr<TrackingMeter> tracking;       ///< null with TrackingMode::off
  std::unique_ptr<OvertakingMeter> overtaking;   ///< null without opponents
  std::optional<tracking::Predictor> predictor;  ///< with `tracking`
  sim::CollisionLog log;
  LapResult result;
  Sums sums;
  Command applied;                          ///< the command that the car executes now
  std::vector<sim::PurePursuit> pursuits;   ///< of opponents, by speed
  std::vector<sim::RacingOpponent> racers;  ///< opponents that look where they drive
  std::vector<int> drivers;                 ///< per opponent: index in `racers`, or -1 - index in `pursuits`
  std::vector<Command> commands{1};         ///< of all cars
  /// Commands that were sent but not yet applied, each with the simulation step in which it takes effect.
  std::vector<std::pair<std::int64_t, Command>> pending;
};

}  // namespace slalom::evaluation
