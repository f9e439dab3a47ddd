#include "slalom/evaluation/rooms/room_drive.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "evaluation/rooms/mover_watch.hpp"
#include "evaluation/rooms/room_figures.hpp"
#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"
#include "slalom/evaluation/drive.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/navigation/scan_map.hpp"

namespace slalom::evaluation {

namespace {

using maps::Pose;
using navigation::NavigationStatus;
using navigation::Velocity;

constexpr double resolution = 0.05;                      // m
constexpr double max_range = 16;                         // m
constexpr double range_noise = 0.01;                     // m, standard deviation
constexpr double start_spread = 0.03, start_turn = 0.1;  // m along each axis, rad: largest changes
constexpr double walker_spread = 0.1, walker_pause = 1;  // share of the speed, s: largest changes
constexpr double standing = 1e-3;                        // m/s and rad/s
constexpr double min_driving_speed = 0.03;               // m/s
constexpr double min_turning_speed = 0.08;               // rad/s
constexpr double unseen = std::numeric_limits<double>::quiet_NaN();  // m
constexpr double least_share = 0.8;  // share of its path that a robot drives to the goal

/// Varies the walkers of a scenario with the seed.
std::vector<sim::Walker> varied(std::vector<sim::Walker> walkers, std::uint64_t seed) {
  RandomStream random({seed, 1});
  for (sim::Walker& each : walkers) {
    each.speed *= 1 + random.uniform(-walker_spread, walker_spread);
    each.pause += random.uniform(0, walker_pause);
  }
  return walkers;
}

Pose varied(const Pose& start, RandomStream& random) {
  const auto spread = [&](double most) { return random.uniform(-most, most); };
  return {start.x + spread(start_spread), start.y + spread(start_spread), start.yaw + spread(start_turn)};
}

/// A robot in a room, among people. Each control period has `parts` steps.
class RoomWorld {
 public:
  static constexpr int parts = 5;

  RoomWorld(const RoomScenario& scenario, std::uint64_t seed, const Pose& start)
      : pose(start),
        room_(scenario.room),
        crowd_(room_, varied(scenario.walkers, seed)),
        body_{{}, scenario.robot_length, scenario.robot_width},
        lag_(scenario.lag),
        late_(static_cast<std::size_t>(std::lround(scenario.delay * parts / room_period))) {
    room_.people.assign(crowd_.bodies().begin(), crowd_.bodies().end());
  }

  /// Moves robot and people. The robot has the velocity that the only command was a while ago.
  void step(std::span<const Velocity> commands) {
    late_.push_back(commands[0]);
    const double dt = room_period / parts, share = lag_ > 0 ? 1 - std::exp(-dt / lag_) : 1;
    const Velocity& asked = late_.front();
    velocity = {velocity.forward + share * (asked.forward - velocity.forward),
                velocity.left + share * (asked.left - velocity.left),
                velocity.turn + share * (asked.turn - velocity.turn)};
    late_.pop_front();
    const double yaw = pose.yaw + 0.5 * dt * velocity.turn;
    const double c = std::cos(yaw), s = std::sin(yaw);
    const maps::Point in_room{c * velocity.forward - s * velocity.left,
                              s * velocity.forward + c * velocity.left};
    pose = {pose.x + dt * in_room.x, pose.y + dt * in_room.y, pose.yaw + dt * velocity.turn};
    const sim::Box body{pose, body_.length, body_.width};
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
  sim::Box body_;
  double lag_;                 ///< s
  std::deque<Velocity> late_;  ///< commands that have no effect yet, one for each step
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
  bool set_path(const Pose& from) {
    path = given_.empty() ? path_from(from) : given_;
    if (!path.empty()) navigator_.set_path(path);
    return !path.empty();
  }
  std::vector<Pose> path_from(const Pose& pose) const { return plan_path(costmap_, body_, pose, goal_); }

  navigation::NavigationResult decide(const RoomWorld& world) {
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
    const auto result = stopwatch.measure([&] {
      return navigator_.update(world.pose, stands_ ? Velocity{} : world.velocity, costmap_, room_period,
                               others);
    });
    command_ = result.command;
    return result;
  }
  Velocity command(const RoomWorld&) const { return command_; }
  void moved(const RoomWorld&) const {}

  Stopwatch stopwatch;     ///< times of the navigator's updates
  std::vector<Pose> path;  ///< the path that was set

 private:
  RandomStream random_;
  std::vector<double> ranges_;
  double half_view_;  ///< rad
  navigation::Footprint body_;
  bool predicts_;
  Pose goal_;
  std::vector<Pose> given_;
  bool stands_;
  MoverWatch watch_;
  navigation::ScanMap map_;
  navigation::Costmap costmap_;
  navigation::Navigator navigator_;
  Velocity command_;
};

bool stands(const Velocity& v, double below = standing) {
  return std::abs(v.forward) < below && std::abs(v.left) < below && std::abs(v.turn) < below;
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

/// A scenario with the heading at the goal that belongs to a seed.
RoomScenario with_heading(RoomScenario scenario, std::uint64_t seed) {
  constexpr double pi = std::numbers::pi;
  if (scenario.any_heading) scenario.goal.yaw = RandomStream({seed, 2}).uniform(-pi, pi);
  return scenario;
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
    drive_.update_p50 = robot().stopwatch.percentile(0.5);
    drive_.update_max = robot().stopwatch.percentile(1);
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
