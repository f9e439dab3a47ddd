#pragma once

#include <atomic>

#include "slalom/evaluation/environment.hpp"
#include "slalom/evaluation/lap_figures.hpp"
#include "slalom/evaluation/lap_settings.hpp"
#include "slalom/evaluation/overtaking_record.hpp"
#include "slalom/evaluation/sequence_cost.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// Returns the seed of lap `lap` (from 0): seed0 + lap (obstacles + 5), as in the program of Honda et al.
/// (ICRA 2024).
constexpr std::uint64_t lap_seed(std::uint64_t seed0, int lap, int obstacles) {
  return seed0 + static_cast<std::uint64_t>(lap) * static_cast<std::uint64_t>(obstacles + 5);
}
/// The seed of the solver's random numbers in a lap: a hash of the lap's seed and the name of the method.
std::uint64_t solver_seed(std::uint64_t lap_seed, std::string_view method);

/// The first collision with a body or a wall.
struct Collision {
  double time = 0;  ///< s
  maps::Pose pose;  ///< pose of the car's centre of gravity
  int body = -1;    ///< index of the body, -1 for a wall
};

/// A control step of the first car, after the planner's update and before its command takes effect. The
/// references are valid until the callback returns.
struct ControlStep {
  int step = 0;                     ///< index of the control step, from 0
  double time = 0;                  ///< s
  double progress = 0;              ///< share of the lap that is driven, 0 ... 1
  int collisions = 0;               ///< collisions so far, as the protocol counts them
  const sim::Observation& seen;     ///< the true state of the car
  const maps::LaserScanView& scan;  ///< input of the planner
  /// Input of the planner. While the car is not localised, that gets a pose of NaN; this is the true one.
  const vehicle::Odometry& odometry;
  const vehicle::PlannerOutput& output;  ///< output of the planner
  const vehicle::Planner& planner;       ///< the planner after the update
  const sim::World& world;               ///< the simulated world
  SequenceCostMeter::Cost cost;          ///< cost of the control sequence that the planner chose
  /// Input of the planner: the other cars that are tracked, with their hypotheses, in the map frame.
  std::span<const maps::PredictedObstacle> others{};
};
/// Function that is called in every control step.
using ControlStepCallback = std::function<void(const ControlStep&)>;

/// Errors of the planner's estimates of state and parameters in a lap; empty if tyres do not slip.
struct EstimationRecord {
  std::vector<float> yaw_rate_error;  ///< rad/s, of each control step, absolute
  std::vector<float> slip_error;      ///< rad, the same
  std::vector<float> speed_error;     ///< m/s, the same
  vehicle::ParameterEstimate last;    ///< parameters of car and ground at the end of the lap
  double informed_time = -1;          ///< s, when the confidence first reached 0.5; -1 if never
};

/// A lap that has ended.
struct LapResult : LapFigures {
  bool cancelled = false;                   ///< stopped by the caller
  std::array<int, 7> planner_status{};      ///< control steps by vehicle::PlannerStatus
  int corrections = 0;                      ///< values that the planner's final check changed
  std::vector<Collision> first_collisions;  ///< one for each body hit and one for walls, in order of time
  std::vector<maps::Pose> obstacles;        ///< the parked cars, centres of gravity
  std::vector<float> solve_ms;              ///< wall-clock time of each solve
  std::vector<float> tick_ms;               ///< wall-clock time of each planner update
  LocalisationRecord localisation;          ///< figures of the localiser, with LapSettings::hardware
  EstimationRecord estimation;  ///< figures of the observers, with vehicle models whose tyres slip
  TrackingRecord tracking;      ///< figures of the tracker, with LapSettings::tracking
  OvertakingRecord overtaking;  ///< figures of encounters, with LapSettings::opponents
};

/// Describes a lap: its course, driver and conditions. All random numbers of a lap follow from its seed, so
/// laps can be driven in any order and on any number of threads, with the same bits.
struct LapSetup {
  std::shared_ptr<const Environment> environment;  ///< course of the lap
  Driver driver;                                   ///< driver of the first car
  LapSettings settings{};                          ///< conditions of the lap

  /// Throws std::invalid_argument if the environment is null, the method is unknown, an option or a setting
  /// is out of range, or the start is off the map or less than 0.15 m from a wall.
  void validate() const;

  maps::Pose start() const;                ///< pose of the centre of gravity
  double control_period() const noexcept;  ///< s of simulated time per command
  double timeout() const;                  ///< s, time limit of a lap
  /// Length of a lap along the path, m: from start to finish, after `settings.rounds` rounds of the course.
  double length() const;
};

/// Makes the planner that `setup.driver` describes. Throws std::invalid_argument as LapSetup::validate does.
vehicle::Planner make_planner(const LapSetup& setup);

/// Drives cars on a course in closed loop and measures the first one. The caller may change the world and the
/// driver between steps; the same changes at the same steps give the same drive.
class LapDrive {
 public:
  /// Puts the cars at their starts. Throws std::invalid_argument as LapSetup::validate does and if an
  /// obstacle or opponent overlaps the start, and std::runtime_error if there is no room for them.
  LapDrive(const LapSetup& setup, std::uint64_t seed);
  ~LapDrive();
  /// A copy continues bit for bit like the original. Environment, maps and threads are shared.
  LapDrive(const LapDrive& other);
  LapDrive& operator=(const LapDrive& other);
  LapDrive(LapDrive&&) noexcept;
  LapDrive& operator=(LapDrive&&) noexcept;

  /// Drives one control period, also beyond the finish. The command takes effect `extra_latency` (s) later
  /// than the settings say.
  void step(const ControlStepCallback& on_step = {}, double extra_latency = 0);
  /// Drives until the finish, the timeout, or until `cancel` becomes true. At the finish the world stops in
  /// the middle of a control period.
  LapResult finish(const ControlStepCallback& on_step = {}, const std::atomic<bool>* cancel = nullptr);

  /// Gives the first car another driver, with a new planner, from the next step on. Throws
  /// std::invalid_argument if an option is out of range or the control period differs.
  void change_driver(const Driver& driver);

  const LapSetup& setup() const noexcept;    ///< setup with the present driver
  int steps() const noexcept;                ///< control steps so far
  sim::World& world() noexcept;              ///< may be changed between steps
  const sim::World& world() const noexcept;  ///< world after the last step
  int collisions() const noexcept;           ///< collisions so far, as the protocol counts them
  /// The first collision with each body so far, in order of time.
  std::span<const Collision> first_collisions() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Drives one lap: LapDrive(setup, seed).finish(on_step, cancel).
LapResult run_lap(const LapSetup& setup, std::uint64_t seed, const ControlStepCallback& on_step = {},
                  const std::atomic<bool>* cancel = nullptr);

}  // namespace slalom::evaluation
