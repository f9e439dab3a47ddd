#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/evaluation/environment.hpp"
#include "slalom/evaluation/lap_settings.hpp"
#include "slalom/evaluation/sequence_cost.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// The seed of lap `lap`: seed0 + lap (obstacles + 5), as the published evaluation has it.
constexpr std::uint64_t lap_seed(std::uint64_t seed0, int lap, int obstacles) {
  return seed0 + static_cast<std::uint64_t>(lap) * static_cast<std::uint64_t>(obstacles + 5);
}
/// The seed of the solver's random numbers in a lap.
std::uint64_t solver_seed(std::uint64_t lap_seed, std::string_view method);

/// The first touch of a body, or of a wall (body -1).
struct Collision {
  double time = 0;  ///< s
  maps::Pose pose;  ///< of the car's centre of gravity
  int body = -1;
};

/// A control step, before the command acts. References last until the callback returns.
struct ControlStep {
  int step = 0;
  double time = 0;      ///< s
  double progress = 0;  ///< of the lap, 0 ... 1
  int collisions = 0;   ///< so far
  const sim::Observation& seen;
  const maps::LaserScanView& scan;
  const vehicle::Odometry& odometry;
  const vehicle::PlannerOutput& output;
  const vehicle::Planner& planner;
  const sim::World& world;
  SequenceCostMeter::Cost cost;  ///< of the sequence sent
};
using ControlStepCallback = std::function<void(const ControlStep&)>;

/// A lap that has ended. Costs are means over its control steps.
struct LapResult {
  std::uint64_t seed = 0;
  bool finished = false;
  bool timeout = false;     ///< given up after `time` seconds
  bool cancelled = false;   ///< told to end
  int collisions = 0;       ///< by the evaluation's way of counting
  int collided_bodies = 0;  ///< different bodies, all walls as one
  bool wall = false;
  double time = 0;  ///< s of the lap; where it is not finished, until its end
  int steps = 0;    ///< control steps
  double state_cost = 0;
  double collision_cost = 0;
  double mean_sequence_cost = 0;    ///< MS = state_cost + collision_cost
  double published_model_cost = 0;  ///< MS with the published model's prediction
  double driven_cost = 0;           ///< MS of the states really driven
  double input_error = 0;           ///< sum of |u| over the sequence sent, rad
  double mean_speed = 0;            ///< m/s
  double mean_path_distance = 0;    ///< m, of the rear axle
  double max_path_distance = 0;     ///< m
  double least_clearance = 0;       ///< m from the body to wall or obstacle, negative inside
  double mean_variance = 0;         ///< of the solver's last distribution, input^2
  double mean_effective_samples = 0;
  std::array<int, 7> planner_status{};  ///< control steps by vehicle::PlannerStatus
  std::vector<Collision> first_collisions;
  std::vector<maps::Pose> obstacles;
  int impassable = 0;               ///< of these, as evaluation::impassable tells
  std::vector<float> solve_ms;      ///< wall clock of each solve
  std::vector<float> tick_ms;       ///< wall clock of each planner update
  LocalisationRecord localisation;  ///< with `hardware`
};

/// Drives laps of one configuration and method, each on its own: world, planner and solver begin anew, all
/// random numbers follow from the lap's seed, and nothing is shared with other runners but the environment.
/// So laps may be driven in any order, by any number of runners in parallel, with the same results bit for
/// bit.
class LapRunner {
 public:
  /// Throws std::invalid_argument on an unknown method, on options and settings out of range and on a start
  /// in a wall.
  LapRunner(std::shared_ptr<const Environment> environment, const vehicle::Configuration& configuration,
            std::string method, const LapSettings& settings);

  /// Drives one lap. `cancel` is looked at in every control step. Throws std::runtime_error if the obstacles
  /// find no place, std::invalid_argument if one of them stands on the start.
  LapResult run(std::uint64_t seed, const ControlStepCallback& on_step = {},
                const std::atomic<bool>* cancel = nullptr);

  double timeout() const noexcept { return timeout_; }         ///< s
  double control_period() const noexcept;                      ///< s of simulated time per command
  const maps::Pose& start() const noexcept { return start_; }  ///< of the centre of gravity
  const Environment& environment() const noexcept { return *environment_; }
  const std::string& method() const noexcept { return method_; }
  const vehicle::Configuration& configuration() const noexcept { return configuration_; }

 private:
  friend class ClosedLoop;
  struct Drive;
  std::unique_ptr<Drive> begin(std::uint64_t seed) const;
  std::vector<maps::Pose> place_obstacles(std::uint64_t seed) const;
  std::vector<maps::Pose> place_opponents(const std::vector<maps::Pose>& obstacles) const;
  std::unique_ptr<vehicle::Planner> make_planner() const;
  bool at_finish(const sim::World& world) const noexcept;
  double progress(const sim::World& world) const noexcept;
  void control(Drive& drive, const ControlStepCallback& on_step, double further_latency = 0) const;
  void advance(Drive& drive, bool past_finish = false) const;
  void finish(Drive& drive) const;

  std::shared_ptr<const Environment> environment_;
  std::vector<maps::ReferencePoint> path_;  ///< the environment's, with the speeds of this lap
  vehicle::Configuration configuration_;
  std::string method_;
  LapSettings settings_;
  maps::Pose start_;
  double timeout_ = 0;
  double open_length_ = 0;  ///< m to drive where the course is no loop; 0 for loops
};

}  // namespace slalom::evaluation
