#pragma once

#include <filesystem>

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/base.hpp"
#include "slalom/sim/room/crowd.hpp"
#include "slalom/sim/room/room.hpp"

namespace slalom::evaluation {

/// The end of a drive in a room.
enum class RoomOutcome {
  reached,    ///< the robot stands at the goal
  blocked,    ///< it said that there is no way, and stands
  occupied,   ///< it said that the goal is occupied, and stands
  ignored,    ///< it said that its commands are ignored
  early,      ///< it stands at the goal before the end of the path
  collision,  ///< its body overlapped a wall, an obstacle or a person
  struck,     ///< the same, while it drove and turned slower than 0.03 m/s and rad/s: somebody walked into it
  timeout,    ///< neither within the time
};
/// The name of an outcome, as it is written in results.
constexpr const char* name(RoomOutcome outcome) noexcept {
  constexpr const char* names[] = {"reached", "blocked",   "occupied", "ignored",
                                   "early",   "collision", "struck",   "timeout"};
  return names[static_cast<int>(outcome)];
}

/// A task for a mobile robot in a room.
struct RoomScenario {
  std::string name{};     ///< as the command line writes it
  std::string summary{};  ///< one line
  /// Its first obstacle is the one whose sides are counted, and if there is none the first walker. In a drive
  /// its `people` are those of `walkers`.
  sim::Room room{};
  maps::Pose start{}, goal{};                 ///< m, m, rad
  RoomOutcome wanted = RoomOutcome::reached;  ///< the end that is a success; if the robot says something
                                              ///< else of that kind, the drive goes on
  std::vector<sim::Walker> walkers{};         ///< people; a drive varies their speeds and pauses
  navigation::BaseOptions base{};             ///< limits of the robot
  std::vector<maps::Pose> path{};             ///< to follow; empty: planned on the map
  bool any_heading = false;                   ///< whether the seed draws the heading at the goal
  int cusps = 0;                       ///< changes between driving forward and back that the path asks for
  double delay = 0;                    ///< s until a command takes effect
  bool odometry_stands = false;        ///< whether the robot is told that it stands
  double lag = 0;                      ///< s, time constant with which the robot follows a command
  double robot_length = 0.7;           ///< m; the robot's origin is in its middle
  double robot_width = 0.5;            ///< m
  double padding = 0;                  ///< m by which the navigator's footprint is larger on each side
  int beams = 240;                     ///< number of beams of a scanner that looks all round
  double view = 2 * std::numbers::pi;  ///< rad; beams outside of it, behind the robot, see nothing
  double goal_reach = 0;               ///< m from the goal at which a drive ends; 0: where the robot says so
  double optimal_time = 0;             ///< s, of BARN's metric; 0: none
};

/// Rooms with obstacles and people.
std::span<const RoomScenario> room_scenarios();
/// Drives along given paths, to headings and goals that need a manoeuvre, and with faults of the robot.
std::span<const RoomScenario> manoeuvre_scenarios();

/// The worlds 0, `every`, 2 `every` ... of the dataset BARN (D. Perille et al., "Benchmarking Metric Ground
/// Navigation", SSRR 2020) in a folder with world_N.world and path_files/path_N.npy, as they are in
/// https://github.com/Daffan/the-barn-challenge. The robot is a Jackal of 0.508 x 0.43 m that knows the world
/// from a scanner of 270 degrees alone, and follows its commands with a lag of 0.15 s, as it is told. Throws
/// IoError if the folder has no world, or a file does not have the format.
std::vector<RoomScenario> barn_scenarios(const std::filesystem::path& folder, int every);

/// The scenario of this name, of either kind. Throws std::invalid_argument with the names if there is none.
const RoomScenario& room_scenario(std::string_view name);

}  // namespace slalom::evaluation
