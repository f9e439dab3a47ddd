#pragma once

#include "slalom/evaluation/rooms/room_scenario.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::evaluation {

/// The driver of a robot.
struct RoomDriver {
  navigation::NavigatorOptions navigator{};  ///< its base is replaced by the scenario's
  /// The method, for that base. Its option `seed` is replaced.
  SolverOptions solver = navigation::svg_mppi_options({});
  bool predict_movers =
      true;  ///< follow and predict moving objects; otherwise they are obstacles of the scans
};

/// s, between two commands, and between two scans.
inline constexpr double room_period = 0.05;

/// A drive.
struct RoomDrive {
  RoomOutcome outcome = RoomOutcome::timeout;  ///< how the drive ended
  bool success = false;                        ///< whether the drive ended as the scenario asks
  double time = 0;                             ///< s, of the drive
  double length = 0;                           ///< m driven
  int side_changes = 0;       ///< changes of the side on which plans pass the object that the scenario counts
  int reversals = 0;          ///< changes between driving forward and back, beside those of the path
  double command_change = 0;  ///< rad/s, root mean square of the changes of the commanded yaw rate
  int turn_changes = 0;       ///< changes between turning left and right faster than 0.08 rad/s
  double aside = 0;           ///< m, largest distance from the path
  double goal_distance = 0;   ///< m from the goal, at the end
  double goal_angle = 0;      ///< rad between its heading and the robot's, at the end
  /// s between the first scan in which a scenario without a way shows it, and the robot saying so; -1 if it
  /// did not. The way is shown to be closed once the search of the map of scans finds none.
  double answer_time = -1;
  /// BARN's metric: optimal time divided by time, which counts as 2 to 8 optimal times; 0 without success.
  double metric = 0;
  double update_p50 = 0, update_max = 0;         ///< s of wall clock, of the navigator's updates
  maps::Pose goal;                               ///< with the heading that was drawn
  std::vector<maps::Pose> trace;                 ///< one pose for each period
  std::vector<std::vector<maps::Point>> people;  ///< the same for each person: where they were, m
};

/// Drives a scenario for up to `timeout` (s), with its path or one planned on the map, which shows neither
/// obstacles nor people; moving objects are known from the scans alone, whose ranges have a standard
/// deviation of 0.01 m. The seed varies the start by up to 0.03 m and 0.1 rad, the walkers' speeds by up to a
/// tenth, and their pauses by up to 1 s. The same seed gives the same drive, but for the times of the
/// updates. Throws std::invalid_argument where the timeout is not within [0.001, 86400] or the solver has no
/// option `seed`, and as Navigator does.
RoomDrive drive_room(const RoomScenario& scenario, const RoomDriver& driver, std::uint64_t seed,
                     double timeout = 60);

}  // namespace slalom::evaluation
