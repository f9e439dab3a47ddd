// A robot drives from A to B in a hall. The hall is a map of ROS map_server; the distance to its walls is a
// member of the problem.

#include <array>
#include <cstdio>
#include <exception>

#include <slalom/maps/field.hpp>
#include <slalom/maps/ros_map.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

struct Robot {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad
  };
  static constexpr int inputs = 2;             // speed, m/s; yaw rate, rad/s
  double dt = 0.1;                             // s
  std::array<double, 2> input_min{-0.5, -2};   // m/s, rad/s
  std::array<double, 2> input_max{1.5, 2};     // m/s, rad/s
  std::array<double, 2> input_rate_max{2, 8};  // m/s^2, rad/s^2
  double goal_x = 12.5, goal_y = 7;            // m
  double radius = 0.3, margin = 0.2;           // m
  slalom::maps::Field walls;                   // distance to the nearest wall, m

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 2>& u) const {
    T s, c;
    slalom::sin_cos(x.yaw, s, c);
    return {x.x + T(dt) * u[0] * c, x.y + T(dt) * u[0] * s, x.yaw + T(dt) * u[1]};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& x, const slalom::Input<T, 2>& u) const {
    const T clearance = walls.value(x.x, x.y) - T(radius);
    const T too_near = slalom::max(T(margin) - clearance, T(0));
    const slalom::mask_t<T> hit = clearance < T(0);
    return {T(dt) * (distance(x) + T(0.05) * u[1] * u[1] + T(20) * too_near * too_near) +
                slalom::select(hit, T(100), T(0)),
            hit};
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(3) * distance(x);
  }

  /// To the goal, m.
  template <class T>
  T distance(const State<T>& x) const {
    return slalom::hypot(x.x - T(goal_x), x.y - T(goal_y));
  }
};

/// Whether the robot is within 0.3 m of B after at most 20 s, without a collision.
template <class Controller>
bool arrives(Controller controller) {
  const Robot& robot = controller.problem();
  Robot::State<double> x{1, 1, 1.5};
  for (int k = 0; k < 200 && robot.distance(x) >= 0.3; ++k) {
    x = robot.step(x, controller.solve(x, {.elapsed = robot.dt}).inputs[0]);
    if (robot.walls.value(x.x, x.y) < robot.radius) return false;
  }
  return robot.distance(x) < 0.3;
}

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s examples/hall/hall.yaml\n", argv[0]);
    return 2;
  }
  const Robot robot{.walls = slalom::maps::signed_distance(slalom::maps::load_ros_map(argv[1]))};
  const int mppi = succeeded([&](auto seed) {
    return arrives(slalom::Mppi{
        robot, {.horizon = 40, .samples = 1024, .temperature = 0.5, .variance = {2, 4}, .seed = seed}});
  });
  const int svg_mppi = succeeded([&](auto seed) {
    return arrives(
        slalom::SvgMppi{robot, {.horizon = 40, .samples = 1024, .temperature = 0.5, .seed = seed}});
  });
  return report("the robot arrives", mppi, svg_mppi, 18);
} catch (const std::exception& error) {  // a file that cannot be read
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
