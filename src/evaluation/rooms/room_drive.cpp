#include "slalom/evaluation/rooms/room_drive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "evaluation/rooms/drive_counters.hpp"
#include "evaluation/rooms/mover_watch.hpp"
#include "slalom/core/random.hpp"
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

/// The walkers of a scenario as a seed has them.
std::vector<sim::Walker> varied(std::vector<sim::Walker> walkers, const RoomConditions& conditions,
                                std::uint64_t seed) {
  RandomStream random({seed, 1});
  for (sim::Walker& each : walkers) {
    each.speed *= 1 + random.uniform(-conditions.walker_spread, conditions.walker_spread);
    each.pause += random.uniform(0, conditions.walker_pause);
  }
  return walkers;
}

/// A robot in a room, among people.
class Robot {
 public:
  Robot(const RoomScenario& scenario, const RoomConditions& conditions, std::uint64_t seed)
      : room_(scenario.room),
        crowd_(room_, varied(scenario.walkers, conditions, seed)),
        noise_(conditions.range_noise),
        random_({seed, 0}),
        ranges_(beams) {
    room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
    const auto spread = [&](double most) { return random_.uniform(-most, most); };
    pose = {scenario.start.x + spread(conditions.start_spread),
            scenario.start.y + spread(conditions.start_spread),
            scenario.start.yaw + spread(conditions.start_turn)};
  }

  /// Where the first obstacle is, or else the first walker; far away if there is neither.
  maps::Point counted() const {
    if (!room_.obstacles.empty()) return {room_.obstacles[0].pose.x, room_.obstacles[0].pose.y};
    return room_.people.empty() ? maps::Point{1e6, 1e6} : room_.people[0].middle;
  }
  std::span<const sim::Disc> people() const { return room_.people; }
  navigation::RangeScan scan() {
    sim::scan(room_, pose, max_range, ranges_);
    for (double& range : ranges_)
      if (range < max_range) range = std::max(range + noise_ * random_.normal(), 0.0);
    return {pose, ranges_, max_range};
  }
  /// Drives with constant velocity, while people walk; returns the way driven, m.
  double move(const Velocity& command, double period) {
    constexpr int parts = 5;
    const double dt = period / parts;
    for (int i = 0; i < parts; ++i) {
      const double yaw = pose.yaw + 0.5 * dt * command.turn, c = std::cos(yaw), s = std::sin(yaw);
      pose = {pose.x + dt * (c * command.forward - s * command.left),
              pose.y + dt * (s * command.forward + c * command.left), pose.yaw + dt * command.turn};
      const sim::Box body{pose, RoomScenario::robot_length, RoomScenario::robot_width};
      if (!room_.people.empty()) {
        crowd_.step(dt, body,
                    {c * command.forward - s * command.left, s * command.forward + c * command.left});
        room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
      }
      collided = collided || sim::collides(room_, body);
    }
    velocity = command;
    return period * std::hypot(command.forward, command.left);
  }

  Pose pose;
  Velocity velocity;
  bool collided = false;

 private:
  sim::Room room_;
  sim::Crowd crowd_;
  double noise_;
  RandomStream random_;
  std::vector<double> ranges_;
};

/// What the robot knows of the room: its map, and what scans have shown besides.
class Knowledge {
 public:
  Knowledge(const RoomScenario& scenario, bool predicts)
      : predicts_(predicts),
        watch_(beams),
        map_(sim::map_of(scenario.room, resolution)),
        costmap(map_.grid().width, map_.grid().height, resolution) {
    costmap.update(map_.grid());
  }
  void add(const navigation::RangeScan& scan, double time) {
    if (predicts_) others = watch_.update(scan, time);
    map_.add(predicts_ ? watch_.without_movers() : scan);
    costmap.update(map_.grid());
  }

 private:
  bool predicts_;
  MoverWatch watch_;
  navigation::ScanMap map_;

 public:
  navigation::Costmap costmap;
  std::span<const maps::PredictedObstacle> others;  ///< what moves
};

bool stands(const Velocity& v, double below = standing) {
  return std::abs(v.forward) < below && std::abs(v.left) < below && std::abs(v.turn) < below;
}

}  // namespace

RoomDrive drive_room(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                     const RoomConditions& conditions) {
  validate_options(conditions, "conditions");
  SolverOptions solver = driver.solver;
  std::uint64_t* const solver_seed = solver.find<std::uint64_t>("seed");
  if (!solver_seed)
    throw std::invalid_argument("method " + std::string(solver.method()) +
                                ": must have the option seed of type std::uint64_t");
  *solver_seed = seed;
  constexpr double half_length = 0.5 * RoomScenario::robot_length;
  const navigation::Footprint footprint =
      navigation::Footprint::rectangle(half_length, half_length, RoomScenario::robot_width);
  Knowledge known(scenario, driver.predict_movers);
  Robot robot(scenario, conditions, seed);
  const auto path_from = [&](const Pose& pose) {
    return plan_path(known.costmap, footprint, pose, scenario.goal);
  };
  const std::vector<Pose> path = path_from(robot.pose);
  if (path.empty()) throw std::invalid_argument(std::string("scenario: ") + scenario.name + ": has no path");

  navigation::NavigatorOptions options = driver.navigator;
  options.base = scenario.base;
  navigation::Navigator navigator(footprint, options, solver, known.costmap);
  navigator.set_path(path);

  RoomDrive drive;
  drive.people.resize(robot.people().size());
  SideCounter sides(scenario.start, scenario.goal);
  ReversalCounter reversals;
  Stopwatch stopwatch;
  double shown_closed = -1;  // s
  const int periods = static_cast<int>(std::ceil(conditions.timeout / conditions.period));
  for (int i = 0; i < periods && !robot.collided; ++i) {
    drive.time = i * conditions.period;
    drive.trace.push_back(robot.pose);
    for (std::size_t k = 0; k < drive.people.size(); ++k) drive.people[k].push_back(robot.people()[k].middle);
    known.add(robot.scan(), drive.time);
    if (!scenario.has_way && shown_closed < 0 && path_from(robot.pose).empty()) shown_closed = drive.time;
    const auto result = stopwatch.measure([&] {
      return navigator.update(robot.pose, robot.velocity, known.costmap, conditions.period, known.others);
    });
    sides.add(robot.pose, robot.counted(), result.plan);
    const bool blocked = result.status == NavigationStatus::blocked;
    if (blocked && drive.answer_time < 0 && shown_closed >= 0) drive.answer_time = drive.time - shown_closed;
    drive.length += robot.move(result.command, conditions.period);
    reversals.add(robot.velocity.forward);
    if (!stands(robot.velocity)) continue;
    if (result.status == NavigationStatus::goal_reached) drive.outcome = RoomOutcome::reached;
    if (blocked && !scenario.has_way) drive.outcome = RoomOutcome::blocked;
    if (drive.outcome != RoomOutcome::timeout) break;
  }
  if (robot.collided)
    drive.outcome = stands(robot.velocity, min_driving_speed) ? RoomOutcome::struck : RoomOutcome::collision;
  drive.success = drive.outcome == (scenario.has_way ? RoomOutcome::reached : RoomOutcome::blocked);
  drive.side_changes = sides.changes();
  drive.reversals = reversals.changes();
  drive.update_p50 = stopwatch.percentile(0.5);
  drive.update_max = stopwatch.percentile(1);
  return drive;
}

}  // namespace slalom::evaluation
