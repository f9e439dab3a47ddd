#pragma once

#include <deque>

#include "slalom/core/random.hpp"
#include "slalom/evaluation/rooms/mover_watch.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/navigation/scan_map.hpp"

/// A robot in a room, as `drive_room` and the live view drive it.
namespace slalom::evaluation {

/// Varies the start of a drive.
maps::Pose varied(const maps::Pose& start, RandomStream& random);
/// The heading at the goal that belongs to a seed.
RoomScenario with_heading(RoomScenario scenario, std::uint64_t seed);
/// A solver with this seed.
SolverOptions with_seed(SolverOptions solver, std::uint64_t seed);

/// A robot in a room, among people. Each control period has `parts` steps.
class RoomWorld {
 public:
  static constexpr int parts = 5;  ///< steps of a control period

  /// Puts the robot at its start, and the walkers where the seed has them.
  RoomWorld(const RoomScenario& scenario, std::uint64_t seed, const maps::Pose& start);

  /// Moves robot and people. The robot has the velocity that the only command was a while ago.
  void step(std::span<const navigation::Velocity> commands);

  /// The walls, obstacles and people now.
  const sim::Room& room() const { return room_; }
  /// Puts an obstacle elsewhere: a box, or a post.
  void move_obstacle(std::size_t index, const maps::Point& to);
  /// Whether the robot's body overlaps something now.
  bool collides() const { return sim::collides(room_, {pose, body_.length, body_.width}); }
  /// The middle of the first obstacle, or else of the first walker; far away if there is neither.
  maps::Point counted() const;

  maps::Pose pose;                ///< that of the robot
  navigation::Velocity velocity;  ///< that of the robot, in its own frame
  bool collided = false;          ///< whether the robot has overlapped something
  double time = 0;                ///< s, at the start of the control period

 private:
  sim::Room room_;
  sim::Crowd crowd_;
  sim::Box body_;
  double lag_;                             ///< s
  std::deque<navigation::Velocity> late_;  ///< commands that have no effect yet, one for each step
};

/// The robot's scanner, its map of what the scans have shown, and its navigator.
class RoomNavigator {
 public:
  /// Throws std::invalid_argument if an option is out of range.
  RoomNavigator(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                const RandomStream& random);

  /// Follows the scenario's path, or one that it plans from a pose; false if the map shows none.
  bool set_path(const maps::Pose& from);
  /// A path to the goal from a pose; empty if the map shows none.
  std::vector<maps::Pose> path_from(const maps::Pose& pose) const {
    return plan_path(costmap_, body_, pose, goal_);
  }

  /// Follows a path that it plans to another goal; false, and nothing changes, if the map shows none.
  bool set_goal(const maps::Pose& goal, const maps::Pose& from);
  /// Where the robot is to go.
  const maps::Pose& goal() const { return goal_; }
  /// Drives on with another navigator.
  void replace(const navigation::NavigatorOptions& options, const SolverOptions& solver);
  /// The navigator that decides.
  const navigation::Navigator& navigator() const { return navigator_; }

  /// Takes a scan, and decides; `elapsed` s after the last decision.
  navigation::NavigationResult decide(const RoomWorld& world, double elapsed = room_period);
  /// The command of the last decision.
  navigation::Velocity command(const RoomWorld&) const { return command_; }
  /// Nothing: the map follows the scans alone.
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
