#pragma once

#include <optional>

#include "slalom/maps/command.hpp"
#include "slalom/maps/imu_reading.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"
#include "slalom/vehicle/planner/planner_options.hpp"

/// The planner: scan and odometry in, steering and speed out.
///
///     Planner planner({}, make_vehicle_model({}), path, make_solver(SvgMppiOptions{}, 1));
///     while (driving) {
///       const Command command = planner.update({scan, odometry}).command;
///       send(command.steer, command.speed);
///     }
namespace slalom::vehicle {

namespace detail {
class PlannerBase;
}

/// The covariance of a pose: x, y (m, map frame) and yaw (rad). All 0 if it is not known.
using PoseCovariance = std::array<std::array<double, 3>, 3>;

/// Pose of the rear axle and speed, from odometry or localisation.
struct Odometry {
  static constexpr double fastest = 200;  ///< m/s, largest magnitude that a planner takes as a speed
  maps::Pose pose;                        ///< m, m, rad, in the map frame, within maps::PoseLimits
  double speed = 0;                       ///< m/s
  PoseCovariance covariance{};            ///< covariance of `pose`; all 0: the pose counts as exact
};

/// The reason for a command.
enum class PlannerStatus {
  ok,
  blocked,        ///< every plan collides or, with tyre slip, the car reverses. Without tyre slip only with
                  ///< `verify_plan` and `stop_when_blocked`; otherwise such a plan is sent as `ok`
  fallback_plan,  ///< the solution collided; another sequence, which does not, was sent
  bad_scan,       ///< empty, or of an invalid geometry: braking
  bad_odometry,   ///< not finite, or larger than `Odometry` allows: braking
  off_course,     ///< further from the path than the reference field reaches: braking
  solver_degenerate,  ///< no usable weights or no finite cost; the sequence that the solver falls back to was
                      ///< sent
};
/// Returns the name of a status, as it is written in results.
constexpr const char* name(PlannerStatus status) noexcept {
  constexpr const char* names[] = {"ok",           "blocked",    "fallback_plan",    "bad_scan",
                                   "bad_odometry", "off_course", "solver_degenerate"};
  return names[static_cast<int>(status)];
}

/// The input of an update.
struct PlannerInput {
  maps::LaserScanView scan;                  ///< the scan, in the frame of the laser
  Odometry odometry;                         ///< at the time of the scan
  std::span<const maps::Point> obstacles{};  ///< further obstacle points, robot frame, m
  std::optional<ImuReading> imu{};           ///< mean since the last update, if the car has a unit. Used with
                                             ///< models whose tyres slip, if it is `plausible`
  /// Other cars and their predictions from the time of the scan on, map frame; used with `predict_others`.
  /// Readings of these cars are not obstacles, and count as invalid in the report of the scan.
  std::span<const maps::PredictedObstacle> others{};
  /// The command that the car obeys from now on, if it is not the planner's: that of a person who drives, or
  /// of a recording. Ignored if it is not finite.
  std::optional<Command> obeyed{};
  /// The highest speed from now on, m/s, if it is below `max_speed`. Nothing that was learned changes.
  /// Ignored if it is negative or not a number.
  std::optional<double> goal_speed{};
};

/// Estimates of the car and the ground.
struct ParameterEstimate {
  double friction = 0;                 ///< mean
  double friction_deviation = 0;       ///< standard deviation
  double cautious_friction = 0;        ///< friction on which plans rely: a quantile, at most the given value
  double steering_gain = 1;            ///< angle of the wheels / commanded angle, mean
  double steering_gain_deviation = 0;  ///< standard deviation
  double steering_offset = 0;          ///< rad, angle of the wheels at the command 0
  double delay = 0;                    ///< s, from sending a steering command to its first effect, mean
  double delay_deviation = 0;          ///< s, standard deviation
  double confidence = 0;  ///< 0 ... 1, how far the drive has reduced the variance of log(friction): 1 -
                          ///< variance / prior variance. 0 if the car has not turned
};

/// The outcome of an update. Spans stay valid until the next one. For any input the command is finite and
/// within `steer_limit` and `max_speed`. In reverse it is at most 0.7 m/s. If the planner brakes, it is not
/// faster than the car.
struct PlannerOutput {
  PlannerStatus status = PlannerStatus::ok;  ///< result of the update
  Command command;                           ///< to send now
  std::span<const float> inputs;  ///< [step][input], the sequence that is sent: steering in rad, and with
                                  ///< two inputs acceleration in m/s^2; empty if none is sent
  int inputs_per_step = 1;        ///< number of inputs of a step
  /// The horizon + 1 states of the sequence that is sent. Empty if none is sent or its cost is not finite.
  std::span<const PredictedState> predicted;
  double state_cost = 0;               ///< cost of the predicted states without collisions
  double collision_cost = 0;           ///< cost of the collisions of the predicted states
  double steer_estimate = 0;           ///< rad, of the steering observer
  double speed_estimate = 0;           ///< m/s, of the observer; 0 if tyres do not slip
  double yaw_rate_estimate = 0;        ///< rad/s, of the observer; 0 if tyres do not slip
  double slip_estimate = 0;            ///< rad, of the observer; 0 if tyres do not slip
  ParameterEstimate parameters;        ///< estimate of car and ground; its friction is 0 if tyres do not slip
  const SolveResult* solve = nullptr;  ///< result of the solver; null if nothing was solved
  maps::ScanReport scan;               ///< number of beams that were used, and why others were not
  double tick_time = 0;                ///< s of wall clock for the whole update
  int corrections = 0;                 ///< values that the final check changed; 0 in normal operation
};

/// The car's planner. After construction an update neither allocates nor throws.
class Planner {
 public:
  /// Drives `model` along `path` with `solver`. The points are as for ReferenceField. The path is closed if
  /// its ends are near each other (see path_geometry), otherwise open. Throws std::invalid_argument if an
  /// option is out of range, the path is invalid, model or solver is null, or their numbers of inputs differ.
  Planner(const PlannerOptions& options, std::unique_ptr<VehicleModel> model,
          std::span<const maps::ReferencePoint> path, std::unique_ptr<Solver> solver);
  ~Planner();
  /// A copy continues bit for bit like the original. The threads of the solver are shared.
  Planner(const Planner& other);
  Planner& operator=(const Planner& other);
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;

  /// Plans from scan and odometry. Call it once per `control_period`.
  const PlannerOutput& update(const PlannerInput& input) noexcept;

  /// Forgets everything learned and all commands sent. The solver restarts its random numbers from `seed`.
  void reset(std::uint64_t seed) noexcept;

  /// Predicts the states (one more than steps) under any control sequence [step][input] and returns their
  /// cost. Starts where the last plan started, on the maps of that plan. For viewers; may be called between
  /// updates. Before the first plan, and after `reset`, the cost is 0 and the states are not set.
  PredictedCost predict(std::span<const float> inputs, std::span<PredictedState> states) const noexcept;

  /// The solver in use.
  const Solver& solver() const noexcept;
  /// The cost map of the last scan. If the model uses a map of distances (`vehicle.body: discs`), only its
  /// points are set.
  const maps::LocalCostMap& cost_map() const noexcept;

 private:
  std::unique_ptr<detail::PlannerBase> implementation_;
};

}  // namespace slalom::vehicle
