#include "slalom/evaluation/rooms/room_drive.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

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
constexpr double max_range = 8;                          // m
constexpr int beams = 240;
constexpr double side_margin = 0.1;         // m from the line to the obstacle; less is no side
constexpr double min_driving_speed = 0.03;  // m/s that counts as driving
constexpr double standing = 1e-3;           // m/s

/// Counts how often plans change the side on which they pass an obstacle, until the robot is past it.
class SideCounter {
 public:
  SideCounter(const RoomScenario& scenario)
      : obstacle_(scenario.room.obstacles.front().pose),
        ahead_x_(scenario.goal.x - scenario.start.x),
        ahead_y_(scenario.goal.y - scenario.start.y) {}

  void add(const Pose& robot, std::span<const Pose> plan) {
    const double dx = obstacle_.x - robot.x, dy = obstacle_.y - robot.y;
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
  Pose obstacle_;
  double ahead_x_, ahead_y_;
  int last_ = 0, changes_ = 0;
};

/// A robot in a room.
class Robot {
 public:
  Robot(const RoomScenario& scenario, const RoomConditions& conditions, std::uint64_t seed)
      : room_(scenario.room), noise_(conditions.range_noise), random_({seed, 0}), ranges_(beams) {
    const auto spread = [&](double most) { return random_.uniform(-most, most); };
    pose = {scenario.start.x + spread(conditions.start_spread),
            scenario.start.y + spread(conditions.start_spread),
            scenario.start.yaw + spread(conditions.start_turn)};
  }

  navigation::RangeScan scan() {
    sim::scan(room_, pose, max_range, ranges_);
    for (double& range : ranges_)
      if (range < max_range) range = std::max(range + noise_ * random_.normal(), 0.0);
    return {pose, ranges_, max_range};
  }
  /// Drives with constant velocity; returns the way driven, m.
  double move(const Velocity& command, double period) {
    constexpr int parts = 5;
    const double dt = period / parts;
    for (int i = 0; i < parts; ++i) {
      const double yaw = pose.yaw + 0.5 * dt * command.turn, c = std::cos(yaw), s = std::sin(yaw);
      pose = {pose.x + dt * (c * command.forward - s * command.left),
              pose.y + dt * (s * command.forward + c * command.left), pose.yaw + dt * command.turn};
      collided = collided || sim::collides(room_, {pose, 2 * half_length, 2 * half_width});
    }
    velocity = command;
    return period * std::hypot(command.forward, command.left);
  }

  Pose pose;
  Velocity velocity;
  bool collided = false;

 private:
  const sim::Room& room_;
  double noise_;
  RandomStream random_;
  std::vector<double> ranges_;
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

bool stands(const Velocity& v) {
  return std::abs(v.forward) < standing && std::abs(v.left) < standing && std::abs(v.turn) < standing;
}

}  // namespace

RoomDrive drive_room(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                     const RoomConditions& conditions) {
  const navigation::Footprint footprint =
      navigation::Footprint::rectangle(half_length, half_length, 2 * half_width);
  navigation::ScanMap map(sim::map_of(scenario.room, resolution));
  navigation::Costmap costmap(map.grid().width, map.grid().height, resolution);
  costmap.update(map.grid());
  Robot robot(scenario, conditions, seed);
  const std::vector<Pose> path = plan_path(costmap, footprint, robot.pose, scenario.goal);
  if (path.empty()) throw std::invalid_argument(std::string("scenario: ") + scenario.name + ": has no path");

  SolverOptions solver = driver.solver;
  *solver.find<std::uint64_t>("seed") = seed;
  navigation::Navigator navigator(footprint, driver.navigator, solver, costmap);
  navigator.set_path(path);

  RoomDrive drive;
  SideCounter sides(scenario);
  Stopwatch stopwatch;
  double shown_closed = -1;  // s
  int direction = 1;
  const int periods = static_cast<int>(std::ceil(conditions.timeout / conditions.period));
  for (int i = 0; i < periods && !robot.collided; ++i) {
    drive.time = i * conditions.period;
    drive.trace.push_back(robot.pose);
    map.add(robot.scan());
    costmap.update(map.grid());
    if (!scenario.has_way && shown_closed < 0 &&
        plan_path(costmap, footprint, robot.pose, scenario.goal).empty())
      shown_closed = drive.time;
    const auto result = stopwatch.measure(
        [&] { return navigator.update(robot.pose, robot.velocity, costmap, conditions.period); });
    sides.add(robot.pose, result.plan);
    if (result.status == NavigationStatus::blocked && drive.answer_time < 0 && shown_closed >= 0)
      drive.answer_time = drive.time - shown_closed;
    drive.length += robot.move(result.command, conditions.period);
    const int now = robot.velocity.forward > min_driving_speed    ? 1
                    : robot.velocity.forward < -min_driving_speed ? -1
                                                                  : 0;
    drive.reversals += now == -direction;
    if (now != 0) direction = now;
    if (result.status == NavigationStatus::goal_reached && stands(robot.velocity)) {
      drive.outcome = RoomOutcome::reached;
      break;
    }
    if (result.status == NavigationStatus::blocked && stands(robot.velocity) && !scenario.has_way) {
      drive.outcome = RoomOutcome::blocked;
      break;
    }
  }
  if (robot.collided) drive.outcome = RoomOutcome::collision;
  drive.success = drive.outcome == (scenario.has_way ? RoomOutcome::reached : RoomOutcome::blocked);
  drive.side_changes = sides.changes();
  stopwatch.report(drive);
  return drive;
}

}  // namespace slalom::evaluation
