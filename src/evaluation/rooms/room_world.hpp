#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "mover_watch.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/random.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/navigation/scan_map.hpp"

/// A robot in a room, as `drive_room` and the live view drive it.
namespace slalom::evaluation {

/// Varies the walkers of a scenario with the seed.
inline std::vector<sim::Walker> varied(std::vector<sim::Walker> walkers, std::uint64_t seed) {
  constexpr double spread = 0.1, longest_pause = 1;  // share of the speed, s: largest changes
  RandomStream random({seed, 1});
  for (sim::Walker& each : walkers) {
    each.speed *= 1 + random.uniform(-spread, spread);
    each.pause += random.uniform(0, longest_pause);
  }
  return walkers;
}

/// Varies the start of a drive.
inline maps::Pose varied(const maps::Pose& start, RandomStream& random) {
  constexpr double start_spread = 0.03, start_turn = 0.1;  // m along each axis, rad: largest changes
  const auto spread = [&](double most) { return random.uniform(-most, most); };
  return {start.x + spread(start_spread), start.y + spread(start_spread), start.yaw + spread(start_turn)};
}

/// The heading at the goal that belongs to a seed.
inline RoomScenario with_heading(RoomScenario scenario, std::uint64_t seed) {
  constexpr double pi = std::numbers::pi;
  if (scenario.any_heading) scenario.goal.yaw = RandomStream({seed, 2}).uniform(-pi, pi);
  return scenario;
}

/// A robot in a room, among people. Each control period has `parts` steps.
class RoomWorld {
 public:
  static constexpr int parts = 5;

  RoomWorld(const RoomScenario& scenario, std::uint64_t seed, const maps::Pose& start)
      : pose(start),
        room_(scenario.room),
        crowd_(room_, varied(scenario.walkers, seed)),
        body_{{}, scenario.robot_length, scenario.robot_width},
        lag_(scenario.lag),
        late_(saturate_cast<std::size_t>(std::round(scenario.delay * parts / room_period))) {
    room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
  }

  /// Moves robot and people. The robot has the velocity that the only command was a while ago.
  void step(std::span<const navigation::Velocity> commands) {
    late_.push_back(commands[0]);
    const double dt = room_period / parts, share = lag_ > 0 ? 1 - std::exp(-dt / lag_) : 1;
    const navigation::Velocity& asked = late_.front();
    velocity = {velocity.forward + share * (asked.forward - velocity.forward),
                velocity.left + share * (asked.left - velocity.left),
                velocity.turn + share * (asked.turn - velocity.turn)};
    late_.pop_front();
    const double yaw = pose.yaw + 0.5 * dt * velocity.turn;
    const double c = std::cos(yaw), s = std::sin(yaw);
    const maps::Point in_room{c * velocity.forward - s * velocity.left,
                              s * velocity.forward + c * velocity.left};
    pose = {pose.x + dt * in_room.x, pose.y + dt * in_room.y, pose.yaw + dt * velocity.turn};
    if (!room_.people.empty()) {
      crowd_.step(dt, {pose, body_.length, body_.width}, in_room);
      room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
    }
    collided = collided || collides();
  }

  const sim::Room& room() const { return room_; }
  /// Puts an obstacle elsewhere: a box, or a post.
  void move_obstacle(std::size_t index, const maps::Point& to) {
    const std::size_t boxes = room_.obstacles.size();
    if (index < boxes)
      room_.obstacles[index].pose = {to.x, to.y, room_.obstacles[index].pose.yaw};
    else
      room_.posts.at(index - boxes).middle = to;
    crowd_.set_obstacles(room_);
  }
  /// Whether the robot's body overlaps something now.
  bool collides() const { return sim::collides(room_, {pose, body_.length, body_.width}); }
  /// The middle of the first obstacle, or else of the first walker; far away if there is neither.
  maps::Point counted() const {
    if (!room_.obstacles.empty()) return {room_.obstacles[0].pose.x, room_.obstacles[0].pose.y};
    return room_.people.empty() ? maps::Point{1e6, 1e6} : room_.people[0].middle;
  }

  maps::Pose pose;
  navigation::Velocity velocity;
  bool collided = false;
  double time = 0;  ///< s, at the start of the control period

 private:
  sim::Room room_;
  sim::Crowd crowd_;
  sim::Box body_;
  double lag_;                             ///< s
  std::deque<navigation::Velocity> late_;  ///< commands that have no effect yet, one for each step
};

/// A solver with this seed.
inline SolverOptions with_seed(SolverOptions solver, std::uint64_t seed) {
  std::uint64_t* const solver_seed = solver.find<std::uint64_t>("seed");
  if (!solver_seed)
    throw std::invalid_argument("method " + std::string(solver.method()) +
                                ": must have the option seed of type std::uint64_t");
  *solver_seed = seed;
  return solver;
}

/// A navigator for this base.
inline navigation::NavigatorOptions with_base(navigation::NavigatorOptions options,
                                              const navigation::BaseOptions& base) {
  options.base = base;
  return options;
}

/// The robot's scanner, its map of what the scans have shown, and its navigator.
class RoomNavigator {
 public:
  RoomNavigator(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                const RandomStream& random)
      : random_(random),
        ranges_(static_cast<std::size_t>(scenario.beams)),
        half_view_(0.5 * scenario.view),
        body_(navigation::Footprint::rectangle(0.5 * scenario.robot_length + scenario.padding,
                                               0.5 * scenario.robot_length + scenario.padding,
                                               scenario.robot_width + 2 * scenario.padding)),
        predicts_(driver.predict_movers),
        goal_(scenario.goal),
        given_(scenario.path),
        stands_(scenario.odometry_stands),
        watch_(ranges_.size()),
        map_(sim::map_of(scenario.room, resolution)),
        costmap_(map_.grid().width, map_.grid().height, resolution),
        navigator_((costmap_.update(map_.grid()), body_), with_base(driver.navigator, scenario.base),
                   with_seed(driver.solver, seed), costmap_) {}

  /// Follows the scenario's path, or one that it plans from a pose; false if the map shows none.
  bool set_path(const maps::Pose& from) {
    path = given_.empty() ? path_from(from) : given_;
    if (!path.empty()) navigator_.set_path(path);
    return !path.empty();
  }
  std::vector<maps::Pose> path_from(const maps::Pose& pose) const {
    return plan_path(costmap_, body_, pose, goal_);
  }

  /// Follows a path that it plans to another goal; false, and nothing changes, if the map shows none.
  bool set_goal(const maps::Pose& goal, const maps::Pose& from) {
    const std::vector<maps::Pose> way = plan_path(costmap_, body_, from, goal);
    if (way.empty()) return false;
    goal_ = goal;
    given_.clear();
    path = way;
    navigator_.set_path(path);
    return true;
  }
  const maps::Pose& goal() const { return goal_; }
  /// Drives on with another navigator.
  void replace(const navigation::NavigatorOptions& options, const SolverOptions& solver) {
    navigator_ = navigation::Navigator(body_, options, solver, costmap_);
    navigator_.set_path(path);
  }
  const navigation::Navigator& navigator() const { return navigator_; }

  /// Takes a scan, and decides; `elapsed` s after the last decision.
  navigation::NavigationResult decide(const RoomWorld& world, double elapsed = room_period) {
    sim::scan(world.room(), world.pose, max_range, ranges_);
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      double& range = ranges_[i];
      if (range < max_range) range = std::max(range + range_noise * random_.normal(), 0.0);
      if (std::abs(maps::wrap_angle(maps::beam_angle(i, ranges_.size()))) > half_view_) range = unseen;
    }
    const navigation::RangeScan scan{world.pose, ranges_, max_range};
    std::span<const maps::PredictedObstacle> others;
    if (predicts_) others = watch_.update(scan, world.time);
    map_.add(predicts_ ? watch_.without_movers() : scan);
    costmap_.update(map_.grid());
    const auto begin = std::chrono::steady_clock::now();
    const auto result = navigator_.update(world.pose, stands_ ? navigation::Velocity{} : world.velocity,
                                          costmap_, elapsed, others);
    update_times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    command_ = result.command;
    return result;
  }
  navigation::Velocity command(const RoomWorld&) const { return command_; }
  void moved(const RoomWorld&) const {}

  std::vector<double> update_times;  ///< s of wall clock, of the navigator's updates
  std::vector<maps::Pose> path;      ///< the path that was set

 private:
  static constexpr double resolution = 0.05;                                  ///< m
  static constexpr double max_range = 16;                                     ///< m
  static constexpr double range_noise = 0.01;                                 ///< m, standard deviation
  static constexpr double unseen = std::numeric_limits<double>::quiet_NaN();  ///< m

  RandomStream random_;
  std::vector<double> ranges_;
  double half_view_;  ///< rad
  navigation::Footprint body_;
  bool predicts_;
  maps::Pose goal_;
  std::vector<maps::Pose> given_;
  bool stands_;
  MoverWatch watch_;
  navigation::ScanMap map_;
  navigation::Costmap costmap_;
  navigation::Navigator navigator_;
  navigation::Velocity command_;
};

}  // namespace slalom::evaluation
