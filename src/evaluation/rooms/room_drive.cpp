#include "slalom/evaluation/rooms/room_drive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "evaluation/rooms/drive_counters.hpp"
#include "evaluation/rooms/mover_watch.hpp"
#include "slalom/core/random.hpp"
#include "slalom/evaluation/drive.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/navigation/scan_map.hpp"

namespace slalom::evaluation {

namespace {

using maps::Pose;
using navigation::NavigationStatus;
using navigation::Velocity;

constexpr double resolution = 0.05;  // m
constexpr double max_range = 16;     // m
constexpr int beams = 240;
constexpr double standing = 1e-3;  // m/s and rad/s

/// Varies the walkers of a scenario with the seed.
std::vector<sim::Walker> varied(std::vector<sim::Walker> walkers, const RoomConditions& conditions,
                                std::uint64_t seed) {
  RandomStream random({seed, 1});
  for (sim::Walker& each : walkers) {
    each.speed *= 1 + random.uniform(-conditions.walker_spread, conditions.walker_spread);
    each.pause += random.uniform(0, conditions.walker_pause);
  }
  return walkers;
}

/// A robot in a room, among people. Each control period has `parts` steps.
class RoomWorld {
 public:
  static constexpr int parts = 5;

  RoomWorld(const RoomScenario& scenario, const RoomConditions& conditions, std::uint64_t seed,
            const Pose& start)
      : pose(start),
        room_(scenario.room),
        crowd_(room_, varied(scenario.walkers, conditions, seed)),
        time_step_(conditions.period / parts) {
    room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
  }

  /// Moves robot and people. The robot has the velocity of the only command.
  void step(std::span<const Velocity> commands) {
    velocity = commands[0];
    const double dt = time_step_, yaw = pose.yaw + 0.5 * dt * velocity.turn;
    const double c = std::cos(yaw), s = std::sin(yaw);
    const maps::Point in_room{c * velocity.forward - s * velocity.left,
                              s * velocity.forward + c * velocity.left};
    pose = {pose.x + dt * in_room.x, pose.y + dt * in_room.y, pose.yaw + dt * velocity.turn};
    const sim::Box body{pose, RoomScenario::robot_length, RoomScenario::robot_width};
    if (!room_.people.empty()) {
      crowd_.step(dt, body, in_room);
      room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
    }
    collided = collided || sim::collides(room_, body);
  }

  const sim::Room& room() const { return room_; }
  /// The middle of the first obstacle, or else of the first walker; far away if there is neither.
  maps::Point counted() const {
    if (!room_.obstacles.empty()) return {room_.obstacles[0].pose.x, room_.obstacles[0].pose.y};
    return room_.people.empty() ? maps::Point{1e6, 1e6} : room_.people[0].middle;
  }

  Pose pose;
  Velocity velocity;
  bool collided = false;
  double time = 0;  ///< s, at the start of the control period

 private:
  sim::Room room_;
  sim::Crowd crowd_;
  double time_step_;  ///< s
};

SolverOptions with_seed(SolverOptions solver, std::uint64_t seed) {
  std::uint64_t* const solver_seed = solver.find<std::uint64_t>("seed");
  if (!solver_seed)
    throw std::invalid_argument("method " + std::string(solver.method()) +
                                ": must have the option seed of type std::uint64_t");
  *solver_seed = seed;
  return solver;
}

navigation::NavigatorOptions with_base(navigation::NavigatorOptions options,
                                       const navigation::BaseOptions& base) {
  options.base = base;
  return options;
}

/// The robot's scanner, its map of what the scans have shown, and its navigator.
class RoomNavigator {
 public:
  RoomNavigator(const RoomScenario& scenario, const RoomDriver& driver, const RoomConditions& conditions,
                std::uint64_t seed, const RandomStream& random)
      : conditions_(conditions),
        random_(random),
        ranges_(beams),
        predicts_(driver.predict_movers),
        goal_(scenario.goal),
        watch_(beams),
        map_(sim::map_of(scenario.room, resolution)),
        costmap_(map_.grid().width, map_.grid().height, resolution),
        navigator_((costmap_.update(map_.grid()), footprint()), with_base(driver.navigator, scenario.base),
                   with_seed(driver.solver, seed), costmap_) {}

  /// Plans and follows a path from a pose; false if the map shows none.
  bool set_path(const Pose& from) {
    const std::vector<Pose> path = path_from(from);
    if (!path.empty()) navigator_.set_path(path);
    return !path.empty();
  }
  std::vector<Pose> path_from(const Pose& pose) const {
    return plan_path(costmap_, footprint(), pose, goal_);
  }

  navigation::NavigationResult decide(const RoomWorld& world) {
    sim::scan(world.room(), world.pose, max_range, ranges_);
    for (double& range : ranges_)
      if (range < max_range) range = std::max(range + conditions_.range_noise * random_.normal(), 0.0);
    const navigation::RangeScan scan{world.pose, ranges_, max_range};
    std::span<const maps::PredictedObstacle> others;
    if (predicts_) others = watch_.update(scan, world.time);
    map_.add(predicts_ ? watch_.without_movers() : scan);
    costmap_.update(map_.grid());
    const auto result = stopwatch.measure(
        [&] { return navigator_.update(world.pose, world.velocity, costmap_, conditions_.period, others); });
    command_ = result.command;
    return result;
  }
  Velocity command(const RoomWorld&) const { return command_; }
  void moved(const RoomWorld&) const {}

  Stopwatch stopwatch;  ///< times of the navigator's updates

 private:
  static navigation::Footprint footprint() {
    constexpr double half_length = 0.5 * RoomScenario::robot_length;
    return navigation::Footprint::rectangle(half_length, half_length, RoomScenario::robot_width);
  }

  RoomConditions conditions_;
  RandomStream random_;
  std::vector<double> ranges_;
  bool predicts_;
  Pose goal_;
  MoverWatch watch_;
  navigation::ScanMap map_;
  navigation::Costmap costmap_;
  navigation::Navigator navigator_;
  Velocity command_;
};

bool stands(const Velocity& v, double below = standing) {
  return std::abs(v.forward) < below && std::abs(v.left) < below && std::abs(v.turn) < below;
}

}  // namespace

RoomDrive drive_room(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                     const RoomConditions& conditions) {
  validate_options(conditions, "conditions");
  RandomStream random({seed, 0});
  const auto spread = [&](double most) { return random.uniform(-most, most); };
  const Pose start{scenario.start.x + spread(conditions.start_spread),
                   scenario.start.y + spread(conditions.start_spread),
                   scenario.start.yaw + spread(conditions.start_turn)};
  Drive<RoomWorld, RoomNavigator> loop{RoomWorld(scenario, conditions, seed, start), {}, RoomWorld::parts};
  loop.drivers.emplace_back(scenario, driver, conditions, seed, random);
  const RoomWorld& world = loop.world;
  RoomNavigator& navigator = loop.drivers[0];
  if (!navigator.set_path(start))
    throw std::invalid_argument(std::string("scenario: ") + scenario.name + ": has no path");

  RoomDrive drive;
  drive.people.resize(world.room().people.size());
  SideCounter sides(scenario.start, scenario.goal);
  ReversalCounter reversals;
  NavigationStatus status{};
  double shown_closed = -1;  // s
  Observer observer{[&](std::size_t, const navigation::NavigationResult& result) {
                      if (!scenario.has_way && shown_closed < 0 && navigator.path_from(world.pose).empty())
                        shown_closed = drive.time;
                      sides.add(world.pose, world.counted(), result.plan);
                      status = result.status;
                      if (status == NavigationStatus::blocked && drive.answer_time < 0 && shown_closed >= 0)
                        drive.answer_time = drive.time - shown_closed;
                    },
                    [](const RoomWorld&) { return true; }};
  const int periods = static_cast<int>(std::ceil(conditions.timeout / conditions.period));
  for (int i = 0; i < periods && !world.collided && drive.outcome == RoomOutcome::timeout; ++i) {
    drive.time = loop.world.time = i * conditions.period;
    drive.trace.push_back(world.pose);
    for (std::size_t k = 0; k < drive.people.size(); ++k)
      drive.people[k].push_back(world.room().people[k].middle);
    loop.step(observer);
    drive.length += conditions.period * std::hypot(world.velocity.forward, world.velocity.left);
    reversals.add(world.velocity.forward);
    if (!stands(world.velocity)) continue;
    if (status == NavigationStatus::goal_reached) drive.outcome = RoomOutcome::reached;
    if (status == NavigationStatus::blocked && !scenario.has_way) drive.outcome = RoomOutcome::blocked;
  }
  if (world.collided)
    drive.outcome = stands(world.velocity, min_driving_speed) ? RoomOutcome::struck : RoomOutcome::collision;
  drive.success = drive.outcome == (scenario.has_way ? RoomOutcome::reached : RoomOutcome::blocked);
  drive.side_changes = sides.changes();
  drive.reversals = reversals.changes();
  drive.update_p50 = navigator.stopwatch.percentile(0.5);
  drive.update_max = navigator.stopwatch.percentile(1);
  return drive;
}

}  // namespace slalom::evaluation
