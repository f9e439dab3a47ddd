#pragma once

#include "slalom/core/polymorphic.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/navigation/base.hpp"
#include "slalom/navigation/cost_options.hpp"
#include "slalom/navigation/costmap.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/solvers/solver_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom {
struct Trajectories;
}

namespace slalom::navigation {

/// The options of `svg_mppi` for this base: 3000 samples of 56 steps, with deviations in proportion to its
/// speeds.
SvgMppiOptions svg_mppi_options(const BaseOptions& base);
/// The options of any method of the registry: those above that it has, and its defaults for the others. A
/// solve takes about as many rollouts as one of `svg_mppi`, so that every method keeps the control period.
/// Throws std::invalid_argument that lists the names if the method is unknown.
SolverOptions method_options(std::string_view method, const BaseOptions& base);

/// Options of a Navigator, besides those of its solver. `visit_options` below describes the fields.
struct NavigatorOptions {
  BaseOptions base{};   ///< limits of the base
  CostOptions costs{};  ///< weights of the cost of a plan
  double time_step = 0.05;
  double goal_distance = 0.1;
  double goal_angle = 0.15;
  bool find_detours = true;
  double look_ahead = 6;
  double patience = 0.3;
  double stuck_after = 4;
  double goal_room = 0.3;
  int retries = 0;
  double deadline = 0;
};

template <class Options, class Visit>
requires is_options_of<Options, NavigatorOptions>
void visit_options(Options& o, Visit&& visit) {
  visit_options(o.base, visit);
  visit_options(o.costs, visit);
  visit(o.time_step, {"time_step", "s", "duration of a step of a plan", 0.001, 1});
  visit(o.goal_distance, {"goal_distance", "m", "distance at which the goal is reached", 0.001, 100});
  visit(o.goal_angle, {"goal_angle", "rad", "yaw error at which the goal is reached", 0.001, 4});
  visit(o.find_detours,
        {"find_detours", "", "search a way around where the path is blocked; report if none"});
  visit(o.look_ahead, {"look_ahead", "m", "length of path that is checked for obstacles", 0, 100});
  visit(o.patience,
        {"patience", "s", "time without a way before the robot stops and reports that it is blocked", 0, 60});
  visit(o.stuck_after,
        {"stuck_after", "s",
         "time without progress, or half of it standing, before it tries another way; after five it is stuck",
         0.1, 3600});
  visit(o.goal_room, {"goal_room", "m", "room that it leaves before an occupied goal", 0, 100});
  visit(o.retries,
        {"retries", "", "further solves in an update while the plan meets an obstacle, before it brakes", 0,
         100});
  visit(o.deadline, {"deadline", "s", "time limit of a solve; 0: none", 0, 1});
}

/// The behaviour of a navigator.
enum class NavigationStatus {
  following,         ///< follows the path
  detour,            ///< follows a way around the place where the path is blocked
  braking,           ///< the plan soon meets a fixed or moving obstacle: the robot brakes
  blocked,           ///< the path is blocked and there is no way round: the robot stands
  goal_occupied,     ///< something is on the goal: the robot has driven up to it, and stands
  waiting,           ///< stands: it waits for somebody who moves, or tries another way
  stuck,             ///< no progress for five times `stuck_after`: the robot stands for 10 s, and tries again
  commands_ignored,  ///< the velocity stays near 0 although the commands do not
  goal_reached,      ///< the robot stands at the goal
  no_path,           ///< no path was set, or the robot is off the costmap: the robot stands
  bad_input,  ///< a pose or velocity is not finite or absurdly large, a time is negative or not finite, or
              ///< the costmap has another size or resolution: it brakes, or stands
};
/// The name of a status, as it is written in results.
constexpr const char* name(NavigationStatus status) noexcept {
  constexpr const char* names[] = {"following",     "detour",  "braking",  "blocked",
                                   "goal_occupied", "waiting", "stuck",    "commands_ignored",
                                   "goal_reached",  "no_path", "bad_input"};
  static_assert(std::size(names) == static_cast<int>(NavigationStatus::bad_input) + 1);
  return names[static_cast<int>(status)];
}

/// The answer of a navigator.
struct NavigationResult {
  NavigationStatus status = NavigationStatus::no_path;  ///< whether it drives, and if not, why
  /// Finite and within the largest speeds of the base, or on the way to them if the robot drives faster.
  /// Braking reduces speed and yaw rate separately, and may ask an Ackermann base for a tighter turn than it
  /// can.
  Velocity command;
  int corrections = 0;   ///< values of it that the final check changed
  double remaining = 0;  ///< m of path to the goal
  double delay = 0;      ///< s until commands take effect: the longest that was told, or else an estimate
  /// Predicted poses, map frame; the first is now. Empty unless the status is `following`, `detour`,
  /// `waiting`, `commands_ignored` or `braking`; with `braking` the plan is not followed.
  std::span<const maps::Pose> plan;
  std::span<const maps::Pose> path;  ///< path that is followed, with the present detour
};

/// The states of rollouts at one step, an entry for each rollout.
struct RolloutStates {
  int step;                         ///< from 0
  std::span<const double> x, y;     ///< m, map frame
  std::span<const double> yaw;      ///< rad, not wrapped
  std::span<const double> forward;  ///< m/s, driven in this step
  std::span<const double> left;     ///< m/s, driven in this step
  std::span<const double> turn;     ///< rad/s, driven in this step
};

/// A term of the cost of plans: adds the cost per second of each state to `costs`, which is an integral over
/// time like the other terms (CostOptions). It must not throw, and is called from one thread at a time.
using StateCost = std::function<void(const RolloutStates& states, std::span<double> costs)>;

/// Drives a mobile robot along a path to a goal, between the obstacles of a costmap.
///
///     Navigator navigator(Footprint::rectangle(0.35, 0.35, 0.5), {}, costmap);
///     navigator.set_path(path);                                             // when there is a new path
///     const auto result = navigator.update(pose, velocity, costmap, 0.05);  // each control period
///     drive(result.command);
///
/// Where the path is blocked within `look_ahead`, it searches for a way round and keeps to it until that is
/// blocked itself. Construction and `set_path` allocate and may throw; `update` does neither.
class Navigator {
 public:
  /// For costmaps like `costmap`. Throws std::invalid_argument that names the option, its value and the rule.
  Navigator(const Footprint& footprint, const NavigatorOptions& options, const SolverOptions& solver,
            const Costmap& costmap);
  /// Makes a navigator with `svg_mppi`.
  Navigator(const Footprint& footprint, const NavigatorOptions& options, const Costmap& costmap);
  ~Navigator();
  Navigator(const Navigator&);             ///< the copy drives on bit for bit like the original
  Navigator& operator=(const Navigator&);  ///< copies
  Navigator(Navigator&&) noexcept;         ///< the navigator moved from may only be destroyed or assigned to
  Navigator& operator=(Navigator&&) noexcept;  ///< moves

  /// The path to follow, in the map frame, from near the robot to the goal. The yaw of the last pose is the
  /// heading at the goal. Those of the others count if each is within 60 degrees of the direction of the path
  /// or of its opposite: there the robot reverses. Otherwise it drives forward; an Ackermann base reverses
  /// after cusps. It stops at cusps, at corners of more than 60 degrees, and where two poses at one place
  /// differ in yaw: it goes on there with the second yaw. A path that ends like the one that is followed, to
  /// half of goal_distance, changes nothing; one to the same goal in a manoeuvre waits until that ends.
  /// Throws std::invalid_argument unless there is at least one pose, all are within maps::PoseLimits, and the
  /// path is at most 10 km long.
  void set_path(std::span<const maps::Pose> path);

  /// The command for the next control period. `velocity` is that of the robot now, `elapsed` (s) the time
  /// since the last update. `others` are the moving objects, predicted from now on in the map frame, which
  /// the costmap should not show: plans avoid their place at each step. Without any, it predicts what moves
  /// in the costmap.
  NavigationResult update(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                          double elapsed, std::span<const maps::PredictedObstacle> others = {}) noexcept;

  /// Adds a term of your own to the cost of plans, not to the search for detours; an empty function removes
  /// it.
  void set_cost(StateCost cost) noexcept;

  /// The solver's result of the last plan, to show it. Valid until the next update.
  const SolveResult& solution() const noexcept;
  /// The trajectories of control sequences [sequence][step][input] from the start of the last plan, over its
  /// costmap. States are x, y, yaw (m, rad, map frame) and the velocity forward, left and turn (m/s, rad/s)
  /// with which they were reached, cost terms those of NavigationProblem. Allocates.
  Trajectories roll_out(std::span<const float> sequences) const;

  /// Forgets the path and all that was learned on it, and restarts the random numbers from `seed`.
  void reset(std::uint64_t seed) noexcept;

 private:
  class Implementation;
  Polymorphic<Implementation> implementation_;
};

}  // namespace slalom::navigation
