#include "slalom/evaluation/rooms/room_scenario.hpp"

namespace slalom::evaluation {

namespace {

using sim::Box;

/// A box by its corners, parallel to the floor's sides.
Box box(double x0, double y0, double x1, double y1) {
  return {{(x0 + x1) / 2, (y0 + y1) / 2, 0}, x1 - x0, y1 - y0};
}

using Scenarios = std::vector<RoomScenario>;

RoomScenario& add(Scenarios& all, const char* name, const char* summary, const sim::Room& room,
                  const maps::Pose& start, const maps::Pose& goal) {
  all.push_back({name, summary, room, start, goal});
  return all.back();
}

constexpr double right_angle = 0.5 * std::numbers::pi;

/// Something stands on the path, which the map does not show.
void add_obstacles(Scenarios& all) {
  // nav2's issue 5661: the footprint is close to an obstacle and the robot has to go past it.
  add(all, "close-obstacle",
      "the robot starts 0.12 m in front of an obstacle that it has to pass (nav2 issue 5661)",
      {8, 5, {}, {box(2.47, 2.0, 3.2, 3.0)}}, {2, 2.6, 0}, {6.5, 2.6, 0});
  // nav2's pull request 6144: something that the map does not show blocks the path.
  add(all, "pallet-on-path", "a pallet blocks the path; both sides are equally good (nav2 pull request 6144)",
      {9, 5, {}, {box(4, 1.9, 4.8, 3.1)}}, {1, 2.5, 0}, {8, 2.5, 0});
  // The same, where the nearer side of the obstacle ends at a wall.
  add(all, "pallet-by-wall",
      "the shorter way past a pallet is too narrow, the longer one is open (nav2 pull request 6144)",
      {9, 5, {}, {box(4, 0.4, 4.8, 2.1)}}, {1, 1.2, 0}, {8, 1.2, 0});
  add(all, "blocked-door", "a box blocks the door on the path; another door is open",
      {9,
       6,
       {box(4.4, 0, 4.6, 1.5), box(4.4, 2.4, 4.6, 4.2), box(4.4, 5.1, 4.6, 6)},
       {box(4.2, 1.6, 4.9, 2.2)}},
      {1, 2.5, 0}, {8, 2.0, 0});
}

/// Doors, aisles, dead ends.
void add_passages(Scenarios& all) {
  add(all, "narrow-door", "a door 0.2 m wider than the robot, and a goal beside a wall with another heading",
      {8, 5, {box(3.9, 0, 4.1, 2.15), box(3.9, 2.85, 4.1, 5)}, {box(5.6, 1.2, 6.2, 1.8)}}, {1, 3.6, 0},
      {7.2, 0.6, -right_angle});
  add(all, "two-doors", "two doors 0.4 m wider than the robot, one on the left and one on the right",
      {10,
       5,
       {box(3.4, 0, 3.6, 1), box(3.4, 1.9, 3.6, 5), box(6.4, 0, 6.6, 3.1), box(6.4, 4, 6.6, 5)},
       {box(4.6, 2.2, 5.2, 2.8)}},
      {1, 2.5, 0}, {9, 2.5, 0});
  add(all, "pallet-aisle", "an aisle with pallets on alternating sides",
      {14, 2.6, {}, {box(3.5, 0, 4.3, 1.3), box(6.3, 1.3, 7.1, 2.6), box(9.1, 0, 9.9, 1.3)}}, {1, 1.3, 0},
      {13, 1.3, 0});
  add(all, "dead-end", "a box closes the end of a corridor; the robot sees it only after the bend",
      {10, 6, {box(3, 1.4, 7, 4), box(8.4, 0, 8.6, 4)}, {box(7, 3.2, 8.4, 3.8)}}, {4.5, 0.7, 0},
      {7.7, 5.2, right_angle});
  add(all, "u-trap", "a U-shaped screen across the path, open towards the robot",
      {9, 6, {}, {box(4.6, 2, 4.8, 4), box(3.4, 2, 4.6, 2.2), box(3.4, 3.8, 4.6, 4)}}, {1, 3, 0}, {8, 3, 0});
}

/// The robot has to say that it cannot reach the goal.
void add_closed(Scenarios& all) {
  add(all, "no-way", "a pallet closes the corridor: the robot has to report that there is no way",
      {9, 2, {}, {box(5, 0.3, 5.8, 1.7)}}, {1, 1, 0}, {8, 1, 0})
      .wanted = RoomOutcome::blocked;
  add(all, "closed-door", "the only door is closed: the robot has to report that there is no way",
      {9, 5, {box(4.4, 0, 4.6, 2), box(4.4, 3, 4.6, 5)}, {box(4.45, 2, 4.5, 3)}}, {1, 2.5, 0}, {8, 2.5, 0})
      .wanted = RoomOutcome::blocked;
}

/// One person walks.
void add_walkers(Scenarios& all) {
  add(all, "oncoming-walker", "a person walks towards the robot in a corridor 2.4 m wide", {12, 2.4, {}, {}},
      {1, 1.2, 0}, {11, 1.2, 0})
      .walkers = {{{{11.5, 1.2}, {0.5, 1.2}}, 0.8}};
  add(all, "inattentive-walker", "a person who ignores the robot walks towards it in a corridor 3 m wide",
      {12, 3, {}, {}}, {1, 1.5, 0}, {11, 1.5, 0})
      .walkers = {{{{11.5, 1.5}, {0.5, 1.5}}, 0.8, 0.25, 0, false}};
  add(all, "slow-walker", "a person walks ahead at half of the robot's speed in a corridor 3 m wide",
      {14, 3, {}, {}}, {1, 1.5, 0}, {12.5, 1.5, 0})
      .walkers = {{{{2.6, 1.5}, {13.5, 1.5}}, 0.25}};
  add(all, "crossing-walker", "a person who ignores the robot crosses the path when it arrives",
      {9, 6, {}, {}}, {1, 3, 0}, {8, 3, 0})
      .walkers = {{{{4.5, 5.5}, {4.5, 0.5}}, 0.7, 0.25, 3.2, false}};
  add(all, "blind-corner", "a person comes out of a side corridor 1 m in front of the robot",
      {10, 5, {box(0, 3, 4.4, 3.2), box(6, 3, 10, 3.2)}, {}}, {1, 1.5, 0}, {9, 1.5, 0})
      .walkers = {{{{5.2, 4.6}, {5.2, 0.5}}, 1, 0.25, 5.5}};
}

/// People and more.
void add_traffic(Scenarios& all) {
  add(all, "crowd-crossing", "five people cross the path from both sides when the robot arrives",
      {12, 6, {}, {}}, {1, 3, 0}, {11, 3, 0})
      .walkers = {{{{4.5, 5.5}, {4.5, 0.5}}, 0.9, 0.25, 4.2},
                  {{{5.5, 0.5}, {5.5, 5.5}}, 0.8, 0.25, 6},
                  {{{6.4, 5.5}, {6.4, 0.5}}, 1, 0.25, 8.5},
                  {{{7.2, 0.5}, {7.2, 5.5}}, 0.9, 0.25, 9.8},
                  {{{8, 5.5}, {8, 0.5}}, 0.7, 0.25, 10.8}};
  add(all, "pallet-and-walker",
      "a pallet leaves a gap of 1.2 m, through which a person walks towards the robot",
      {12, 4, {}, {box(5, 1.2, 5.8, 4)}}, {1, 2.2, 0}, {11, 2.2, 0})
      .walkers = {{{{10.5, 0.7}, {0.6, 0.7}}, 0.8, 0.25, 2.5}};
}

/// Other bases than the differential one.
void add_bases(Scenarios& all) {
  navigation::BaseOptions omnidirectional, ackermann;
  omnidirectional.kind = navigation::BaseKind::omnidirectional;
  ackermann.kind = navigation::BaseKind::ackermann;
  ackermann.min_turning_radius = 0.7;
  add(all, "omnidirectional-door",
      "an omnidirectional base passes a door; at start and goal it faces at right angles to the path",
      {8, 5, {box(3.9, 0, 4.1, 2.05), box(3.9, 2.95, 4.1, 5)}, {box(5.6, 1.2, 6.2, 1.8)}},
      {1, 2.5, right_angle}, {7, 2.5, right_angle})
      .base = omnidirectional;
  add(all, "ackermann-aisle",
      "a base with a turning radius of 0.7 m passes pallets on both sides of an aisle",
      {14, 3, {}, {box(4, 0, 4.8, 1.5), box(8, 1.5, 8.8, 3)}}, {1, 1.5, 0}, {13, 1.5, 0})
      .base = ackermann;
}

std::vector<RoomScenario> make_scenarios() {
  std::vector<RoomScenario> all;
  add_obstacles(all);
  add_passages(all);
  add_closed(all);
  add_walkers(all);
  add_traffic(all);
  add_bases(all);
  return all;
}

}  // namespace

std::span<const RoomScenario> room_scenarios() {
  static const std::vector<RoomScenario> all = make_scenarios();
  return all;
}

const RoomScenario& room_scenario(std::string_view name) {
  std::string names;
  for (const auto& scenarios : {room_scenarios(), manoeuvre_scenarios()})
    for (const RoomScenario& each : scenarios) {
      if (name == each.name) return each;
      names += (names.empty() ? "" : ", ") + each.name;
    }
  throw std::invalid_argument("'" + std::string(name) + "' must be one of " + names);
}

}  // namespace slalom::evaluation
