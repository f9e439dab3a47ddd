#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/evaluation/environment.hpp"
#include "slalom/evaluation/estimation_record.hpp"
#include "slalom/evaluation/lap_settings.hpp"
#include "slalom/evaluation/overtaking_record.hpp"
#include "slalom/evaluation/sequence_cost.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// The seed of lap `lap` (from 0): seed0 + lap (obstacles + 5), as in the program of Honda et al. (ICRA
/// 2024).
constexpr std::uint64_t lap_seed(std::uint64_t seed0, int lap, int obstacles) {
  return seed0 + static_cast<std::uint64_t>(lap) * static_cast<std::uint64_t>(obstacles + 5);
}
/// The seed of the solver's random numbers in a lap: a hash of the lap's seed and the name of the method.
std::uint64_t solver_seed(std::uint64_t lap_seed, std::string_view method);

/// The first collision with a body or a wall.
struct Collision {
  double time = 0;  ///< s
  maps::Pose pose;  ///< of the car's centre of gravity
  int body = -1;    ///< index of the body, -1 for a wall
};

/// A control step after the planner's update and before its command is applied. The references are valid
/// until the callback returns.
struct ControlStep {
  int step = 0;                     ///< index of the control step, from 0
  double time = 0;                  ///< s
  double progress = 0;              ///< of the lap, 0 ... 1
  int collisions = 0;               ///< so far, as the protocol counts them
  const sim::Observation& seen;     ///< the true state of the car
  const maps::LaserScanView& scan;  ///< input of the planner
  /// Input of the planner. While the car is not localised, the planner gets a pose of NaN; this is the true
  /// one.
  const vehicle::Odometry& odometry;
  const vehicle::PlannerOutput& output;  ///< output of the planner
  const vehicle::Planner& planner;       ///< after the update
  const sim::World& world;               ///< the simulated world
  SequenceCostMeter::Cost cost;          ///< of the control sequence that the planner chose
  /// Input of the planner: the other cars that are tracked, with their hypotheses, in the map frame.
  std::span<const maps::PredictedObstacle> others{};
};
/// Called in every control step.
using ControlStepCallback = std::function<void(const ControlStep&)>;

/// A lap that has ended. Costs and other means are over its control steps.
struct LapResult {
  std::uint64_t seed = 0;         ///< seed of the random numbers
  bool finished = false;          ///< whether the car reached the finish in time
  bool timeout = false;           ///< stopped after the timeout of the lap
  bool cancelled = false;         ///< stopped by the caller
  int collisions = 0;             ///< as the protocol counts them
  int collided_bodies = 0;        ///< number of different bodies hit, all walls as one
  bool wall = false;              ///< whether the car hit a wall
  double time = 0;                ///< s, of the lap; if it was not finished, until it ended
  int steps = 0;                  ///< control steps
  double state_cost = 0;          ///< mean, of distance and yaw error
  double collision_cost = 0;      ///< mean
  double mean_sequence_cost = 0;  ///< MS = state_cost + collision_cost
  double paper_model_cost =
      0;                   ///< MS predicted with the model of the paper's program; with `additional_costs`
  double driven_cost = 0;  ///< MS of the states that the car reached; with `additional_costs`
  double input_error = 0;  ///< mean of the sum of |steering| over the control sequence, rad
  double mean_speed = 0;   ///< m/s
  double mean_path_distance = 0;  ///< m, of the rear axle
  double max_path_distance = 0;   ///< m
  /// m, the least over the control steps: from the corners of the car to a wall (0 in a wall, with the error
  /// of Track::distance_to_wall) and from its outline to other bodies (negative in a collision). Infinite if
  /// there is neither.
  double min_clearance = 0;
  double mean_variance = 0;             ///< of the steering in the solver's distribution, rad^2; over solves
  double mean_effective_samples = 0;    ///< mean of the solver's effective sample size over solves
  std::array<int, 7> planner_status{};  ///< control steps by vehicle::PlannerStatus
  int corrections = 0;                  ///< values that the planner's final check changed
  std::vector<Collision> first_collisions;  ///< one for each body hit and one for walls, in order of time
  std::vector<maps::Pose> obstacles;        ///< the parked cars, centres of gravity
  int impassable = 0;                       ///< number of obstacles in impassable_obstacles
  std::vector<float> solve_ms;              ///< wall-clock time of each solve
  std::vector<float> tick_ms;               ///< wall-clock time of each planner update
  LocalisationRecord localisation;          ///< with LapSettings::hardware
  EstimationRecord estimation;              ///< with vehicle models whose tyres slip
  TrackingRecord tracking;                  ///< with LapSettings::tracking
  OvertakingRecord overtaking;              ///< with LapSettings::opponents
};

/// Drives laps of one configuration and method. Each lap is independent of the others: world, planner and
/// solver are reset, all random numbers follow from the seed of the lap, and runners share only the
/// environment. So laps can be driven in any order, by any number of runners in parallel, with the same
/// results bit for bit.
class LapRunner {
 public:
  /// Throws std::invalid_argument if `environment` is null, the method is unknown, an option or a setting is
  /// out of range, or the start is off the map or less than 0.15 m from a wall.
  LapRunner(std::shared_ptr<const Environment> environment, const vehicle::Configuration& configuration,
            std::string method, const LapSettings& settings);

  /// Drives one lap and calls `on_step` in every control step. Ends early when `cancel` becomes true. Throws
  /// std::runtime_error if there is no room for the obstacles or opponents, std::invalid_argument if one of
  /// them overlaps the start.
  LapResult run(std::uint64_t seed, const ControlStepCallback& on_step = {},
                const std::atomic<bool>* cancel = nullptr);

  double timeout() const noexcept { return timeout_; }         ///< s, after which a lap is stopped
  double control_period() const noexcept;                      ///< s of simulated time per command
  const maps::Pose& start() const noexcept { return start_; }  ///< of the centre of gravity
  const Environment& environment() const noexcept { return *environment_; }  ///< where laps are driven
  const std::string& method() const noexcept { return method_; }             ///< name of the method
  /// The options of planner, vehicle problem and methods.
  const vehicle::Configuration& configuration() const noexcept { return configuration_; }
  /// The settings of each lap.
  const LapSettings& settings() const noexcept { return settings_; }
  /// m along the path of the course from the start of a lap to its finish, which is after `rounds` times
  /// around the course.
  double lap_length() const noexcept;

 private:
  friend class ClosedLoop;
  friend class DriverStack;
  struct LapInProgress;
  std::unique_ptr<LapInProgress> begin(std::uint64_t seed) const;
  std::vector<maps::Pose> place_obstacles(std::uint64_t seed) const;
  std::vector<maps::Pose> place_opponents(const std::vector<maps::Pose>& obstacles) const;
  std::shared_ptr<const LapRunner> planning_opponent(int index) const;
  void make_opponents(LapInProgress& lap) const;
  void command_opponents(LapInProgress& lap, bool decide) const;
  std::unique_ptr<vehicle::Planner> make_planner() const;
  bool at_finish(const sim::World& world) const noexcept;
  double progress(const sim::World& world) const noexcept;
  void control(LapInProgress& lap, const ControlStepCallback& on_step, double extra_latency = 0) const;
  void advance(LapInProgress& lap, bool past_finish = false) const;
  void record_collisions(LapInProgress& lap) const;
  void finish(LapInProgress& lap) const;

  std::shared_ptr<const Environment> environment_;
  std::vector<maps::ReferencePoint> path_;  ///< the environment's, with the speeds of this lap
  vehicle::Configuration configuration_;
  std::string method_;
  LapSettings settings_;
  double speed_share_ = 1;  ///< of the path's speeds, which the planner is given
  /// Drivers of the opponents that have a planner, in their order.
  std::vector<std::shared_ptr<const LapRunner>> planning_opponents_;
  maps::Pose start_;
  double timeout_ = 0;
  double open_length_ = 0;  ///< m to drive on an open course; 0 on closed courses
};

}  // namespace slalom::evaluation
