
#include "slalom/evaluation/rooms/room_scenario.hpp"

namespace slalom::evaluation {

namespace manoeuvres {

using maps::Pose;
using navigation::BaseKind;
using Path = std::vector<Pose>;

constexpr double pi = std::numbers::pi;

static sim::Box box(double x0, double y0, double x1, double y1) {
  return {{(x0 + x1) / 2, (y0 + y1) / 2, 0}, x1 - x0, y1 - y0};
}

static navigation::BaseOptions base_of(BaseKind kind, double turning_radius = 0.2) {
  return {.kind = kind, .min_turning_radius = turning_radius};
}

/// A scenario along a path.
static RoomScenario along(const char* name, const char* summary, const sim::Room& room, const Path& path) {
  RoomScenario made{name, summary, room, path.front(), path.back()};
  made.path = path;
  return made;
}

static RoomScenario heading(const char* name, const char* summary, BaseKind kind) {
  RoomScenario made{name, summary, {10, 6, {}, {}}, {2, 3, 0}, {7, 3, 0}};
  made.base = base_of(kind, 0.4);
  made.any_heading = true;
  return made;
}

/// Past the bay to a cusp, back on an arc, and straight in.
static RoomScenario bay() {
  Path path;
  for (int i = 0; i < 40; ++i) path.push_back({1 + 0.1 * i, 3, 0});
  for (int i = 0; i < 32; ++i) path.push_back({5 - std::sin(0.05 * i), 2 + std::cos(0.05 * i), 0.05 * i});
  for (int i = 0; i < 20; ++i) path.push_back({4, 1.95 - 0.05 * i, pi / 2});
  RoomScenario made = along("bay", "a car with a turning radius of 0.8 m reverses into a bay 1.2 m wide",
                            {8, 5, {box(2.9, 0, 3.4, 2), box(4.6, 0, 5.1, 2)}, {}}, path);
  made.base = base_of(BaseKind::ackermann, 0.8);
  made.cusps = 1;
  return made;
}

static RoomScenario straight(const char* name, const char* summary) {
  return along(name, summary, {12, 4, {}, {}}, {{1, 2, 0}, {10, 2, 0}});
}

static RoomScenario delayed(const char* name, const char* summary, double delay, bool is_told) {
  RoomScenario made = straight(name, summary);
  made.delay = delay;
  if (is_told) made.base.delay_forward = made.base.delay_turn = delay;
  return made;
}

static std::vector<RoomScenario> make_scenarios() {
  std::vector<RoomScenario> all;
  all.push_back(heading("heading", "an empty room, any heading at the goal", BaseKind::differential));
  all.push_back(heading("heading-omnidirectional", "the same", BaseKind::omnidirectional));
  all.push_back(heading("heading-ackermann", "the same; the turning radius is 0.4 m", BaseKind::ackermann));
  all.push_back(bay());
  all.push_back(along("loop", "a closed path of 20 m, whose goal is where the robot starts", {8, 6, {}, {}},
                      {{1, 1, 0}, {7, 1, pi / 2}, {7, 5, pi}, {1, 5, -pi / 2}, {1, 1, 0}}));
  all.push_back(along("dock", "past the goal, and back to it", {9, 3, {}, {}},
                      {{2, 1.5, 0}, {6, 1.5, 0}, {4.5, 1.5, 0}}));
  all.push_back(along("rows", "rows 0.6 m apart", {10, 4, {}, {}},
                      {{1, 1, 0}, {8, 1, 0}, {8, 1.6, 0}, {1, 1.6, 0}, {1, 2.2, 0}, {8, 2.2, 0}}));
  all.push_back(straight("straight", "a straight path in an empty room"));
  all.push_back(delayed("delay", "commands act 0.5 s late, as the robot is told", 0.5, true));
  all.push_back(delayed("delay-untold", "commands act 0.3 s late, which the robot is not told", 0.3, false));
  RoomScenario occupied{"occupied-goal",
                        "something stands on the goal: the robot has to drive up to it and to say so",
                        {12, 5, {}, {box(8.8, 2.3, 9.2, 2.7)}},
                        {1, 2.5, 0},
                        {9, 2.5, 0},
                        RoomOutcome::occupied};
  all.push_back(occupied);
  RoomScenario ignored = straight("odometry-stands", "the robot is told that it stands, and has to say so");
  ignored.odometry_stands = true;
  ignored.wanted = RoomOutcome::ignored;
  all.push_back(ignored);
  RoomScenario corridor{"corridor-turn",
                        "a robot that cannot reverse turns round in a corridor 1.1 m wide",
                        {10, 2, {box(0, 1.1, 10, 2)}, {}},
                        {5, 0.55, 0},
                        {1, 0.55, pi}};
  corridor.base.max_reverse = 0;
  all.push_back(corridor);
  all.push_back({"tight-door",
                 "a door 0.1 m wider than the robot",
                 {8, 5, {box(3.9, 0, 4.1, 2.2), box(3.9, 2.8, 4.1, 5)}, {}},
                 {1, 2.5, 0},
                 {7, 2.5, 0}});
  RoomScenario posts{"posts", "posts, at 2 m/s", {14, 5, {}, {}}, {1, 2.5, 0}, {13, 2.5, 0}};
  for (int i = 0; i < 12; ++i) {
    const double x = 2.5 + 0.8 * i, y = 0.8 + std::fmod(1.7 * i, 3.4);
    posts.room.walls.push_back(box(x, y, x + 0.1, y + 0.1));
  }
  posts.base.max_forward = 2;
  all.push_back(posts);
  return all;
}

}  // namespace manoeuvres

std::span<const RoomScenario> manoeuvre_scenarios() {
  static const std::vector<RoomScenario> all = manoeuvres::make_scenarios();
  return all;
}

}  // namespace slalom::evaluation
