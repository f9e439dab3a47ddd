#pragma once

#include <memory>
#include <span>
#include <vector>

#include "slalom/maps/command.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/vehicle/model/path_tracking.hpp"

/// From scan and odometry to steering and speed:
///
///     Planner planner(options, path, make_solver("svg_mppi", ...));
///     while (driving) {
///       const Command command = planner.update({scan, odometry, 0.025}).command;
///       send(command.steer, command.speed);
///     }
namespace slalom::vehicle {

/// Options of the planner round the solver.
struct PlannerOptions {
  double control_period = 0.025;  ///< s, from one update to the next
  double latency = 0;             ///< s, from the scan to the moment a command reaches the car; led ahead
  double observer_time_constant = 0.1;  ///< s, of the steering observer
  double max_speed = 100;               ///< m/s, caps the path's speeds
  double steer_limit = 0.4189;          ///< rad, commands are clamped to it
  double laser_x = 0.275;               ///< m, of the laser from the rear axle
  double laser_y = 0;                   ///< m, to the left
  double laser_yaw = 0;                 ///< rad
  double speed_lookahead = 0;     ///< s, the commanded speed is that of the path so far ahead, or of the plan
                                  ///< where the acceleration is an input; published: 0
  double deadline = 0;            ///< s a solve may take; 0: no limit
  bool stop_when_blocked = true;  ///< brake when no plan is free of collisions; published: false
  bool verify_plan =
      true;  ///< if the mean collides, send the best guide or sample that does not; published: false
  bool back_up = true;  ///< with `stop_when_blocked` and `verify_plan`: a car that stands with no way ahead
                        ///< goes back a little and tries again; published: false
  bool published_maps = false;  ///< cost map and reference field as the published program makes them
};

template <class Options, class Visit>
requires is_options_of<Options, PlannerOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.control_period, Declaration{.name = "control_period",
                                      .unit = "s",
                                      .help = "from one update to the next",
                                      .min = 1e-3,
                                      .max = 1});
  visit(o.latency, Declaration{.name = "latency",
                               .unit = "s",
                               .help = "from the scan to the command's effect",
                               .min = 0,
                               .max = 1});
  visit(o.observer_time_constant, Declaration{.name = "observer_time_constant",
                                              .unit = "s",
                                              .help = "of the steering observer",
                                              .min = 1e-3,
                                              .max = 10});
  visit(o.max_speed,
        Declaration{
            .name = "max_speed", .unit = "m/s", .help = "caps the path's speeds", .min = 0.01, .max = 100});
  visit(o.steer_limit, Declaration{.name = "steer_limit",
                                   .unit = "rad",
                                   .help = "commands are clamped to it",
                                   .min = 0.01,
                                   .max = 1.5});
  visit(o.laser_x, Declaration{.name = "laser_x",
                               .unit = "m",
                               .help = "where the laser is, ahead of the rear axle",
                               .min = -10,
                               .max = 10});
  visit(o.laser_y, Declaration{.name = "laser_y",
                               .unit = "m",
                               .help = "where the laser is, to the left of it",
                               .min = -10,
                               .max = 10});
  visit(
      o.laser_yaw,
      Declaration{.name = "laser_yaw", .unit = "rad", .help = "where the laser looks", .min = -7, .max = 7});
  visit(o.speed_lookahead, Declaration{.name = "speed_lookahead",
                                       .unit = "s",
                                       .help = "the commanded speed is that of the path so far ahead, or of "
                                               "the plan where the acceleration is an input",
                                       .min = 0,
                                       .max = 2});
  visit(
      o.deadline,
      Declaration{
          .name = "deadline", .unit = "s", .help = "time a solve may take; 0: no limit", .min = 0, .max = 1});
  visit(o.stop_when_blocked,
        Declaration{.name = "stop_when_blocked", .help = "brake when no plan is free of collisions"});
  visit(o.verify_plan,
        Declaration{.name = "verify_plan", .help = "send another sequence if the mean collides"});
  visit(o.back_up,
        Declaration{.name = "back_up", .help = "go back where the car stands and no plan leads ahead"});
  visit(o.published_maps,
        Declaration{.name = "published_maps",
                    .help = "cost map and reference field as the published program makes them"});
}

/// Pose (of the rear axle, map frame) and speed (m/s) as odometry or localisation gives them.
struct Odometry {
  maps::Pose pose;
  double speed = 0;
};

/// Why a command is what it is.
enum class PlannerStatus {
  ok,
  blocked,            ///< every plan collides: braking
  unverified,         ///< the mean collided; another sequence was sent
  bad_scan,           ///< empty, or of the wrong form: braking
  bad_odometry,       ///< not finite: braking
  off_course,         ///< further from the path than the reference field reaches: braking
  solver_degenerate,  ///< the solver had no usable weights; its fallback was sent
};
constexpr const char* name(PlannerStatus status) noexcept {
  switch (status) {
    case PlannerStatus::ok:
      return "ok";
    case PlannerStatus::blocked:
      return "blocked";
    case PlannerStatus::unverified:
      return "unverified";
    case PlannerStatus::bad_scan:
      return "bad_scan";
    case PlannerStatus::bad_odometry:
      return "bad_odometry";
    case PlannerStatus::off_course:
      return "off_course";
    case PlannerStatus::solver_degenerate:
      return "solver_degenerate";
  }
  return "unknown";
}

/// A predicted state, map frame, and where its body is looked up in the robot's frame.
struct PredictedState {
  maps::Pose pose;
  double speed = 0;  ///< m/s
  double steer = 0;  ///< rad
  maps::Pose local;  ///< in the frame of the robot at the time of the scan
};

/// The cost of a predicted sequence, by term.
struct PredictedCost {
  double state = 0;     ///< of distance and yaw, without collisions
  double distance = 0;  ///< the part of `state` that the distance to the path makes
  double collision = 0;
  bool collided = false;
};

struct PlannerInput {
  maps::LaserScanView scan;
  Odometry odometry;
  std::span<const maps::Point> obstacles{};  ///< further obstacle points, robot frame, m
};

/// The outcome of an update. Spans stay valid until the next one.
struct PlannerOutput {
  PlannerStatus status = PlannerStatus::ok;
  Command command;
  std::span<const float> inputs;  ///< [step][input], the sequence that is sent: steering in rad, and with
                                  ///< two inputs acceleration in m/s^2; empty where none is
  int inputs_per_step = 1;
  std::span<const PredictedState> predicted;  ///< horizon + 1 states of the sequence that is sent
  double state_cost = 0;      ///< of the predicted states by the planner's own cost, without collisions
  double collision_cost = 0;  ///< of the predicted states by the planner's own cost
  double steer_estimate = 0;  ///< rad, of the steering observer
  const SolveResult* solve = nullptr;
  maps::ScanReport scan;
  double tick_time = 0;  ///< s of wall clock for the whole update
};

/// The car's planner. After construction an update neither allocates nor throws.
class Planner {
 public:
  /// `path` as for the reference field; `closed` whether it is a loop. Throws std::invalid_argument on
  /// options out of range, on a bad path and on a solver that does not have the problem's inputs.
  Planner(const PlannerOptions& options, const PathTrackingOptions& problem,
          std::span<const maps::ReferencePoint> path, bool closed, std::unique_ptr<Solver> solver);
  ~Planner();
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;

  const PlannerOutput& update(const PlannerInput& input) noexcept;

  /// Forgets everything: solver, observer, commands under way.
  void reset(std::uint64_t seed) noexcept;

  /// The states (one more than steps) and costs of any control sequence, [step][input], from where the last
  /// update that made a plan began, over its maps. For viewers; it may be called between updates.
  PredictedCost predict(std::span<const float> inputs, std::span<PredictedState> states) const noexcept;

  const Solver& solver() const noexcept;
  const maps::LocalCostMap& cost_map() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::vehicle
