#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/hardware_model.hpp"
#include "evaluation/tracking/tracking_meter.hpp"
#include "slalom/evaluation/lap_runner.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::evaluation {

/// What drives one car of a world: its sensors with the localiser, tracker and predictor of other cars,
/// planner, and commands on their way to the car.
class DriverStack {
 public:
  /// For car `car` of a world that has been reset. Configuration, method and settings are those of `runner`,
  /// which must live as long as it drives. All random numbers follow from `seed` and `label`, which tells the
  /// drivers of one race apart.
  DriverStack(const LapRunner& runner, const sim::World& world, std::size_t car, std::uint64_t seed,
              const std::string& label = {});

  /// The world in which laps of `runner` are driven.
  static sim::WorldOptions world_options(const LapRunner& runner);

  /// Steps of the world from one command to the next.
  static long long steps_per_command(const LapRunner& runner, const sim::World& world) noexcept;

  /// An update of the planner.
  struct Update {
    sim::Observation seen;                 ///< the true state of the car
    maps::LaserScanView scan;              ///< input of the planner
    vehicle::Odometry odometry;            ///< input of the planner; if not `localised`, the true one
    bool localised = true;                 ///< whether the planner was given a pose
    const vehicle::PlannerOutput& output;  ///< until the next update
    std::span<const maps::PredictedObstacle> others;  ///< input of the planner, until the next update
  };
  /// Senses, tracks and plans.
  Update update(const sim::World& world);

  /// Sends a command, which takes effect after the latency of the settings and `extra_latency` (s).
  void send(const Command& command, const sim::World& world, double extra_latency = 0);
  /// The command for the next step of the world.
  Command command(const sim::World& world);
  /// To be called after each step of the world.
  void moved(const sim::World& world) noexcept;

  /// Configuration and method of another runner drive from now on, with this planner. Sensors and tracker
  /// stay.
  void change(const LapRunner& runner, std::unique_ptr<vehicle::Planner> planner) noexcept {
    runner_ = &runner;
    planner_ = std::move(planner);
  }
  /// The planner.
  const vehicle::Planner& planner() const noexcept { return *planner_; }
  /// Sensors, where they are simulated; else null.
  const HardwareModel* hardware() const noexcept { return hardware_.get(); }
  /// The tracker with its figures; null with TrackingMode::off.
  const TrackingMeter* tracking() const noexcept { return tracking_.get(); }

 private:
  const LapRunner* runner_;
  std::size_t car_;
  std::unique_ptr<vehicle::Planner> planner_;
  std::unique_ptr<HardwareModel> hardware_;       ///< null where the planner gets exact measurements
  std::unique_ptr<TrackingMeter> tracking_;       ///< null with TrackingMode::off
  std::optional<tracking::Predictor> predictor_;  ///< with `tracking_`
  Command applied_;                               ///< the command that the car executes now
  /// Commands that were sent but not yet applied, each with the simulation step in which it takes effect.
  std::vector<std::pair<std::int64_t, Command>> pending_;
};

}  // namespace slalom::evaluation
