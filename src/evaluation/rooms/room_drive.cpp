#include "slalom/evaluation/rooms/room_drive.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "evaluation/rooms/mover_watch.hpp"
#include "slalom/core/random.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/navigation/scan_map.hpp"

namespace slalom::evaluation {

namespace {

using maps::Pose;
using navigation::NavigationStatus;
using navigation::Velocity;

constexpr double resolution = 0.05;                      // m
constexpr double half_length = 0.35, half_width = 0.25;  // m, of the robot
constexpr double max_range = 16;                         // m
constexpr int beams = 240;
constexpr double side_margin = 0.1;         // m from the line to the obstacle; less is no side
constexpr double min_driving_speed = 0.03;  // m/s that counts as driving
constexpr double standing = 1e-3;           // m/s

/// Counts how often plans change the side on which they pass something, until the robot is past it.
class SideCounter {
 public:
  explicit SideCounter(const RoomScenario& scenario)
      : ahead_x_(scenario.goal.x - scenario.start.x), ahead_y_(scenario.goal.y - scenario.start.y) {}

  void add(const Pose& robot, const maps::Point& counted, std::span<const Pose> plan) {
    const double dx = counted.x - robot.x, dy = counted.y - robot.y;
    if (plan.empty() || dx * ahead_x_ + dy * ahead_y_ <= 0) return;
    const Pose& end = plan.back();
    const double left =
        (dx * (end.y - robot.y) - dy * (end.x - robot.x)) / std::max(std::hypot(dx, dy), 1e-9);
    if (std::abs(left) < side_margin) return;
    const int side = left > 0 ? 1 : -1;
    changes_ += last_ != 0 && side != last_;
    last_ = side;
  }
  int changes() const { return changes_; }

 private:
  double ahead_x_, ahead_y_;
  int last_ = 0, changes_ = 0;
};

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
      const sim::Box body{pose, 2 * half_length, 2 * half_width};
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
    map_.add(predicts_ ? watch_.without_movers(scan) : scan);
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

/// Counts changes between driving forward and back.
class ReversalCounter {
 public:
  void add(double forward) {
    const int now = forward > min_driving_speed ? 1 : forward < -min_driving_speed ? -1 : 0;
    changes_ += now == -direction_;
    if (now != 0) direction_ = now;
  }
  int changes() const { return changes_; }

 private:
  int direction_ = 1, changes_ = 0;
};

/// Wall-clock times of updates.
class Stopwatch {
 public:
  template <class Work>
  auto measure(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    times_.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return result;
  }
  void report(RoomDrive& drive) {
    if (times_.empty()) return;
    std::sort(times_.begin(), times_.end());
    drive.update_p50 = times_[times_.size() / 2];
    drive.update_max = times_.back();
  }

 private:
  std::vector<double> times_;
};

bool stands(const Velocity& v, double below = standing) {
  return std::abs(v.forward) < below && std::abs(v.left) < below && std::abs(v.turn) < below;
}

}  // namespace

RoomDrive drive_room(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                     const RoomConditions& conditions) {
  const navigation::Footprint footprint =
      navigation::Footprint::rectangle(half_length, half_length, 2 * half_width);
  Knowledge known(scenario, driver.predict_movers);
  Robot robot(scenario, conditions, seed);
  const auto path_from = [&](const Pose& pose) {
    return plan_path(known.costmap, footprint, pose, scenario.goal);
  };
  const std::vector<Pose> path = path_from(robot.pose);
  if (path.empty()) throw std::invalid_argument(std::string("scenario: ") + scenario.name + ": has no path");

  navigation::NavigatorOptions options = driver.navigator;
  options.base = scenario.base;
  SolverOptions solver = driver.solver;
  *solver.find<std::uint64_t>("seed") = seed;
  navigation::Navigator navigator(footprint, options, solver, known.costmap);
  navigator.set_path(path);

  RoomDrive drive;
  drive.people.resize(robot.people().size());
  SideCounter sides(scenario);
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
  stopwatch.report(drive);
  return drive;
}

}  // namespace slalom::evaluation
