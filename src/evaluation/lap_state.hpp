#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "evaluation/hardware_model.hpp"
#include "slalom/evaluation/lap_runner.hpp"
#include "slalom/sim/collision_log.hpp"
#include "slalom/sim/pure_pursuit.hpp"

namespace slalom::evaluation {

/// A lap under way.
struct LapRunner::Drive {
  Drive(const sim::WorldOptions& options, const Environment& environment,
        const std::vector<maps::ReferencePoint>& path, const vehicle::Configuration& configuration,
        std::unique_ptr<vehicle::Planner> driver)
      : world(options, environment.track), planner(std::move(driver)), meter(path, configuration.vehicle) {}

  sim::World world;
  std::unique_ptr<vehicle::Planner> planner;
  SequenceCostMeter meter;
  std::unique_ptr<HardwareModel> hardware;  ///< none where everything is measured as it is
  sim::CollisionLog log;
  LapResult result;
  Command acting;                                           ///< what the car does now
  std::optional<sim::PurePursuit> opponents;                ///< drives them all
  std::vector<Command> commands{1};                         ///< of all cars
  std::vector<std::pair<std::int64_t, Command>> under_way;  ///< by the step in which they arrive
  double cost_state = 0, cost_collision = 0, cost_published = 0, cost_driven = 0;
  double input_error = 0, speed = 0, distance = 0, variance = 0, effective = 0;
  int solves = 0;
};

}  // namespace slalom::evaluation
