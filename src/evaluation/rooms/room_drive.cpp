#include "slalom/evaluation/rooms/room_drive.hpp"

#include "slalom/core/math.hpp"
#include "slalom/core/options.hpp"
#include "slalom/evaluation/drive.hpp"
#include "slalom/evaluation/rooms/room_world.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

namespace {

using maps::Pose;
using navigation::NavigationStatus;
using navigation::Velocity;

constexpr double standing = 1e-3;           // m/s and rad/s
constexpr double min_driving_speed = 0.03;  // m/s
constexpr double min_turning_speed = 0.08;  // rad/s
constexpr double least_share = 0.8;         // share of its path that a robot drives to the goal

bool stands(const Velocity& v, double below = standing) {
  return std::abs(v.forward) < below && std::abs(v.left) < below && std::abs(v.turn) < below;
}

/// Counts how often plans change the side on which they pass something, until the robot is past it.
class SideCounter {
 public:
  SideCounter(const maps::Pose& start, const maps::Pose& goal)
      : ahead_x_(goal.x - start.x), ahead_y_(goal.y - start.y) {}

  void add(const maps::Pose& robot, const maps::Point& counted, std::span<const maps::Pose> plan) {
    const double dx = counted.x - robot.x, dy = counted.y - robot.y;
    if (plan.empty() || dx * ahead_x_ + dy * ahead_y_ <= 0) return;
    const maps::Pose& end = plan.back();
    const double left =
        (dx * (end.y - robot.y) - dy * (end.x - robot.x)) / std::max(std::hypot(dx, dy), 1e-9);
    if (std::abs(left) < side_margin) return;
    const int side = left > 0 ? 1 : -1;
    changes_ += last_ != 0 && side != last_;
    last_ = side;
  }
  int changes() const { return changes_; }

 private:
  static constexpr double side_margin = 0.1;  ///< m from the line; below it neither side is counted
  double ahead_x_, ahead_y_;
  int last_ = 0, changes_ = 0;
};

/// Counts the changes of sign of values that are large enough.
class SignCounter {
 public:
  SignCounter(double least, int sign) : least_(least), sign_(sign) {}
  void add(double value) {
    const int now = value > least_ ? 1 : value < -least_ ? -1 : 0;
    changes_ += now != 0 && now == -sign_;
    if (now != 0) sign_ = now;
  }
  int changes() const { return changes_; }

 private:
  double least_;
  int sign_, changes_ = 0;
};

/// The length of a path (m).
double length_of(std::span<const maps::Pose> path) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    length += std::hypot(path[i + 1].x - path[i].x, path[i + 1].y - path[i].y);
  return length;
}

/// The distance of a point from a path (m).
double distance_from(std::span<const maps::Pose> path, const maps::Pose& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double dx = path[i + 1].x - path[i].x, dy = path[i + 1].y - path[i].y,
                 squared = std::max(dx * dx + dy * dy, 1e-12);
    const double share =
        std::clamp(((point.x - path[i].x) * dx + (point.y - path[i].y) * dy) / squared, 0.0, 1.0);
    least = std::min(least, std::hypot(path[i].x + share * dx - point.x, path[i].y + share * dy - point.y));
  }
  return least;
}

/// The end of a drive that a status stands for; a timeout if it goes on.
RoomOutcome outcome_of(NavigationStatus status) {
  switch (status) {
    case NavigationStatus::goal_reached:
      return RoomOutcome::reached;
    case NavigationStatus::blocked:
      return RoomOutcome::blocked;
    case NavigationStatus::goal_occupied:
      return RoomOutcome::occupied;
    case NavigationStatus::commands_ignored:
      return RoomOutcome::ignored;
    default:
      return RoomOutcome::timeout;
  }
}

/// A drive under way, with its figures.
class RoomRun {
 public:
  RoomRun(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed)
      : scenario_(with_heading(scenario, seed)),
        random_({seed, 0}),
        loop_{RoomWorld(scenario, seed, varied(scenario.start, random_)), {}, RoomWorld::parts},
        sides_(scenario.start, scenario.goal) {
    loop_.drivers.emplace_back(scenario_, driver, seed, random_);
    drive_.people.resize(loop_.world.room().people.size());
    if (!robot().set_path(loop_.world.pose))
      throw std::invalid_argument("scenario: " + scenario.name + ": has no path");
  }

  /// Drives one control period; false if the drive has ended.
  bool step(double time) {
    drive_.time = loop_.world.time = time;
    record_places();
    Observer observer{[&](std::size_t, const navigation::NavigationResult& result) { decided(result); },
                      [](const RoomWorld&) { return true; }};
    loop_.step(observer);
    record_way();
    return !ended();
  }

  RoomDrive result() {
    const Pose &pose = loop_.world.pose, &goal = scenario_.goal;
    drive_.success = drive_.outcome == scenario_.wanted;
    drive_.side_changes = sides_.changes();
    drive_.reversals = std::max(reversals_.changes() - scenario_.cusps, 0);
    drive_.turn_changes = turns_.changes();
    drive_.command_change = std::sqrt(squared_changes_ / static_cast<double>(drive_.trace.size()));
    drive_.goal = goal;
    drive_.goal_distance = std::hypot(goal.x - pose.x, goal.y - pose.y);
    drive_.goal_angle = std::abs(maps::wrap_angle(goal.yaw - pose.yaw));
    const double optimal = scenario_.optimal_time;
    if (drive_.success && optimal > 0)
      drive_.metric = optimal / std::clamp(drive_.time, 2 * optimal, 8 * optimal);
    if (const auto& times = robot().update_times; !times.empty()) {
      drive_.update_p50 = percentile(times, 0.5);
      drive_.update_max = percentile(times, 1);
    }
    return drive_;
  }

 private:
  RoomNavigator& robot() { return loop_.drivers[0]; }

  void record_places() {
    drive_.trace.push_back(loop_.world.pose);
    for (std::size_t k = 0; k < drive_.people.size(); ++k)
      drive_.people[k].push_back(loop_.world.room().people[k].middle);
  }

  /// Counts sides, and the time until the robot says that there is no way.
  void decided(const navigation::NavigationResult& result) {
    const RoomWorld& world = loop_.world;
    if (scenario_.wanted == RoomOutcome::blocked && shown_closed_ < 0 &&
        robot().path_from(world.pose).empty())
      shown_closed_ = drive_.time;
    sides_.add(world.pose, world.counted(), result.plan);
    status_ = result.status;
    squared_changes_ += square(result.command.turn - last_turn_);
    last_turn_ = result.command.turn;
    if (status_ == NavigationStatus::blocked && drive_.answer_time < 0 && shown_closed_ >= 0)
      drive_.answer_time = drive_.time - shown_closed_;
  }

  void record_way() {
    const Velocity& velocity = loop_.world.velocity;
    drive_.length += room_period * std::hypot(velocity.forward, velocity.left);
    reversals_.add(velocity.forward);
    turns_.add(velocity.turn);
    drive_.aside = std::max(drive_.aside, distance_from(robot().path, loop_.world.pose));
  }

  bool ended() {
    const RoomWorld& world = loop_.world;
    if (world.collided) {
      const bool stood = stands(world.velocity, min_driving_speed);
      drive_.outcome = stood ? RoomOutcome::struck : RoomOutcome::collision;
    } else if (std::hypot(world.pose.x - scenario_.goal.x, world.pose.y - scenario_.goal.y) <
               scenario_.goal_reach) {
      drive_.outcome = RoomOutcome::reached;
    } else if (const RoomOutcome said = outcome_of(status_);
               said == RoomOutcome::ignored || stands(world.velocity)) {
      if (said == scenario_.wanted || said == RoomOutcome::reached) drive_.outcome = said;
      const double least = least_share * (length_of(robot().path) - 1);
      if (said == RoomOutcome::reached && drive_.length < least) drive_.outcome = RoomOutcome::early;
    }
    return drive_.outcome != RoomOutcome::timeout;
  }

  const RoomScenario scenario_;
  RandomStream random_;
  Drive<RoomWorld, RoomNavigator> loop_;
  SideCounter sides_;
  SignCounter reversals_{min_driving_speed, 1}, turns_{min_turning_speed, 0};
  double squared_changes_ = 0, last_turn_ = 0;
  NavigationStatus status_{};  ///< status of the last decision
  double shown_closed_ = -1;   ///< s, when the map of scans first showed no way; -1 before
  RoomDrive drive_;
};

}  // namespace

RoomDrive drive_room(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                     double timeout) {
  slalom::detail::check("drive", {"timeout", "s", "time after which a drive ends", 0.001, 86400}, timeout);
  RoomRun run(scenario, driver, seed);
  const int periods = saturate_cast<int>(std::ceil(timeout / room_period));
  for (int i = 0; i < periods && run.step(i * room_period); ++i) {
  }
  return run.result();
}

}  // namespace slalom::evaluation
