#include "slalom/evaluation/rooms/room_scenario.hpp"

#include <stdexcept>
#include <string>

namespace slalom::evaluation {

namespace {

using sim::Box;

/// A box by its corners, parallel to the floor's sides.
Box box(double x0, double y0, double x1, double y1) {
  return {{(x0 + x1) / 2, (y0 + y1) / 2, 0}, x1 - x0, y1 - y0};
}

std::vector<RoomScenario> make_scenarios() {
  std::vector<RoomScenario> all;
  // nav2's issue 5661: the footprint is close to an obstacle and the robot has to go past it.
  all.push_back({"close-obstacle",
                 "the robot starts 0.12 m before an obstacle that it has to go past (nav2 issue 5661)",
                 {8, 5, {}, {box(2.47, 2.0, 3.2, 3.0)}},
                 {2, 2.6, 0},
                 {6.5, 2.6, 0}});
  // nav2's pull request 6144: something that the map does not show blocks the path.
  all.push_back(
      {"pallet-on-path",
       "a pallet stands across the path, as far from one side as from the other (nav2 pull request 6144)",
       {9, 5, {}, {box(4, 1.9, 4.8, 3.1)}},
       {1, 2.5, 0},
       {8, 2.5, 0}});
  // The same, where the nearer side of the obstacle ends at a wall.
  all.push_back(
      {"pallet-by-wall",
       "the shorter way past the pallet is too narrow, the longer one is open (nav2 pull request 6144)",
       {9, 5, {}, {box(4, 0.4, 4.8, 2.1)}},
       {1, 1.2, 0},
       {8, 1.2, 0}});
  all.push_back({"blocked-door",
                 "a box stands in the door on the path; another door is open",
                 {9,
                  6,
                  {box(4.4, 0, 4.6, 1.5), box(4.4, 2.4, 4.6, 4.2), box(4.4, 5.1, 4.6, 6)},
                  {box(4.2, 1.6, 4.9, 2.2)}},
                 {1, 2.5, 0},
                 {8, 2.0, 0}});
  all.push_back({"narrow-door",
                 "a door 0.2 m wider than the robot, and a goal beside a wall in another heading",
                 {8, 5, {box(3.9, 0, 4.1, 2.15), box(3.9, 2.85, 4.1, 5)}, {box(5.6, 1.2, 6.2, 1.8)}},
                 {1, 3.6, 0},
                 {7.2, 0.6, -1.5707963267948966}});
  all.push_back({"no-way",
                 "a pallet closes the corridor: the robot has to say that there is no way",
                 {9, 2, {}, {box(5, 0.3, 5.8, 1.7)}},
                 {1, 1, 0},
                 {8, 1, 0},
                 false});
  return all;
}

}  // namespace

std::span<const RoomScenario> room_scenarios() {
  static const std::vector<RoomScenario> all = make_scenarios();
  return all;
}

const RoomScenario& room_scenario(std::string_view name) {
  std::string names;
  for (const RoomScenario& each : room_scenarios()) {
    if (name == each.name) return each;
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  throw std::invalid_argument("scenario: " + std::string(name) + ": must be one of " + names);
}

}  // namespace slalom::evaluation
