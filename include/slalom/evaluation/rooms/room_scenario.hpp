#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/base.hpp"
#include "slalom/sim/room/crowd.hpp"
#include "slalom/sim/room/room.hpp"

namespace slalom::evaluation {

/// A task for a mobile robot in a room.
struct RoomScenario {
  static constexpr double robot_length = 0.7;  ///< m; the robot's origin is in its middle
  static constexpr double robot_width = 0.5;   ///< m

  const char* name = "";     ///< as the command line writes it
  const char* summary = "";  ///< one line
  /// Its first obstacle is the one whose sides are counted, and if there is none the first walker. In a drive
  /// its `people` are those of `walkers`.
  sim::Room room;
  maps::Pose start, goal;  ///< m, m, rad
  bool has_way = true;     ///< whether the goal can be reached; otherwise the robot must say that it cannot
  std::vector<sim::Walker> walkers{};  ///< people; a drive varies their speeds and pauses
  navigation::BaseOptions base{};      ///< limits of the robot
};

/// The scenarios.
std::span<const RoomScenario> room_scenarios();

/// The scenario of this name. Throws std::invalid_argument that lists the names if there is none.
const RoomScenario& room_scenario(std::string_view name);

}  // namespace slalom::evaluation
