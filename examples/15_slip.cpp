// A car follows a line on a slippery floor, where its wheels slip sideways. A network has learned the slip
// from laps that were driven with a model without slip: examples/python/15_slip.py records them on another
// course, trains the network and writes examples/learned/car.npz.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <vector>

#include <slalom/evaluation/environment.hpp>
#include <slalom/maps/field.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

constexpr double dt = 0.05;           // s, of a plan's step
constexpr double steer_max = 0.4189;  // rad
constexpr double rear_length = 0.17145,
                 wheelbase = 0.3302;  // m, rear axle to centre of gravity and to front axle

template <class T>
struct CarState {
  T x, y, yaw;              // m, m, rad, of the centre of gravity
  T ahead, left, yaw_rate;  // m/s, m/s, rad/s
  T steer;                  // rad
};
/// Speeds ahead and to the left (m/s) and yaw rate (rad/s).
template <class T>
using Speeds = std::array<T, 3>;

/// The speeds after a step, if no wheel slips sideways.
struct WithoutSlip {
  template <class T>
  SLALOM_INLINE_CALLS Speeds<T> operator()(const CarState<T>& x, const T& steer,
                                           const T& commanded_speed) const {
    const T gain = slalom::select(commanded_speed > x.ahead, T(4.755), T(19.02));  // 1/s
    const T ahead = x.ahead + T(dt) * slalom::clamp(gain * (commanded_speed - x.ahead), T(-9.51), T(9.51));
    const T yaw_rate = ahead * slalom::tan(steer) * T(1 / wheelbase);
    return {ahead, T(rear_length) * yaw_rate, yaw_rate};
  }
};

/// The speeds after a step, as they were in recorded laps.
struct Learned {
  slalom::Mlp<6, 3> network;

  template <class T>
  SLALOM_INLINE_CALLS Speeds<T> operator()(const CarState<T>& x, const T& steer,
                                           const T& commanded_speed) const {
    const auto speeds = network(x.ahead, x.left, x.yaw_rate, x.steer, steer, commanded_speed);
    return {speeds[0], speeds[1], speeds[2]};
  }
};

/// The line of a course.
struct Line {
  slalom::maps::Field square_distance, speed;  // m^2, m/s

  explicit Line(const std::vector<slalom::maps::ReferencePoint>& path) {
    const auto nearest = [&path](double x, double y) {
      const auto square_distance_to = [&](const auto& p) {
        return slalom::square(x - p.x) + slalom::square(y - p.y);
      };
      return *std::min_element(path.begin(), path.end(), [&](const auto& a, const auto& b) {
        return square_distance_to(a) < square_distance_to(b);
      });
    };
    const auto [left, right] =
        std::minmax_element(path.begin(), path.end(), [](auto a, auto b) { return a.x < b.x; });
    const auto [low, high] =
        std::minmax_element(path.begin(), path.end(), [](auto a, auto b) { return a.y < b.y; });
    const slalom::maps::FieldGeometry grid{static_cast<int>((right->x - left->x + 4) / 0.1),
                                           static_cast<int>((high->y - low->y + 4) / 0.1),
                                           0.1,
                                           {left->x - 2, low->y - 2, 0}};
    square_distance = slalom::maps::Field::from_function(grid, [&](double x, double y) {
      const auto p = nearest(x, y);
      return slalom::square((y - p.y) * std::cos(p.yaw) - (x - p.x) * std::sin(p.yaw));
    });
    speed = slalom::maps::Field::from_function(grid, [&](double x, double y) { return nearest(x, y).speed; });
  }
};

template <class Motion>
struct Car {
  template <class T>
  using State = CarState<T>;
  static constexpr int inputs = 2;  // commands: steering angle, rad; speed, m/s
  double dt = ::dt;
  std::array<double, 2> input_min{-steer_max, 0}, input_max{steer_max, 8};
  Motion motion;
  Line line;

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 2>& u) const {
    const T reach(3.2 * dt);  // rad, of the steering in a step
    const T steer = slalom::clamp(u[0], x.steer - reach, x.steer + reach);
    const auto [ahead, left, yaw_rate] = motion(x, steer, u[1]);
    // Along the means of the step.
    const T way_ahead = T(0.5 * dt) * (x.ahead + ahead), way_left = T(0.5 * dt) * (x.left + left);
    const T turn = T(0.5 * dt) * (x.yaw_rate + yaw_rate);
    T sine, cosine;
    slalom::sin_cos(x.yaw + T(0.5) * turn, sine, cosine);
    return {x.x + way_ahead * cosine - way_left * sine,
            x.y + way_ahead * sine + way_left * cosine,
            x.yaw + turn,
            ahead,
            left,
            yaw_rate,
            steer};
  }
  template <class T>
  T stage_cost(const State<T>& x, const slalom::Input<T, 2>&) const {
    return T(dt) * (T(20) * line.square_distance.value(x.x, x.y) +
                    slalom::square(x.ahead - line.speed.value(x.x, x.y)));
  }
  template <class T>
  T terminal_cost(const State<T>&) const {
    return T(0);
  }
};

/// Laps of many seeds.
struct Laps {
  int finished = 0;  ///< in time, and without touching a wall
  double distance =
      0;  ///< m, mean of the laps' root mean square distance to the line, without the first second
};

template <class Motion>
Laps drive(const slalom::evaluation::Environment& course, const Line& line, const Motion& motion) {
  slalom::sim::WorldOptions options = course.world_options();
  options.time_step = 0.005;
  options.car.friction = 0.4;
  options.lidar.beams = 2;
  options.lidar.rate = 1;
  options.wall_response = slalom::sim::CollisionResponse::count_only;
  Laps laps;
  laps.finished = succeeded([&](auto seed) {
    slalom::sim::World world(options, course.track);
    world.reset(seed, {&course.start, 1});
    slalom::Mppi controller{Car<Motion>{.motion = motion, .line = line},
                            {.horizon = 15,
                             .samples = 256,
                             .temperature = 0.05,
                             .variance = {0.015, 0.5},
                             .control_cost_discount = 1,
                             .seed = seed}};
    bool touched = false;
    double sum = 0;
    int steps = 0;
    while (world.laps(0)->laps() < 1 && world.time() < course.course.length / 2.6) {
      const slalom::sim::CarState& s = world.state(0);
      const auto plan = controller.solve(
          {s.x, s.y, s.yaw, s.speed * std::cos(s.slip), s.speed * std::sin(s.slip), s.yaw_rate, s.steer},
          {.elapsed = dt});
      const slalom::Command command{plan.inputs[0][0], plan.inputs[0][1]};
      for (int k = 0; k < 10; ++k) {
        world.step({&command, 1});
        touched = touched || world.observe(0).collides();
      }
      if (++steps <= 20) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& point : course.path)
        nearest = std::min(nearest, std::hypot(point.x - s.x, point.y - s.y));
      sum += nearest * nearest;
    }
    laps.distance += std::sqrt(sum / std::max(1, steps - 20)) / 20;
    return world.laps(0)->laps() == 1 && !touched;
  });
  std::printf(
      "%d of 20 seeds finish a lap on a slippery floor without touching a wall, %.3f m from the line\n",
      laps.finished, laps.distance);
  return laps;
}

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s courses/mole examples/learned/car.npz\n", argv[0]);
    return 2;
  }
  const auto course =
      slalom::evaluation::load_environment(argv[1], slalom::evaluation::Protocol::true_physics, {});
  const Line line(course->path);
  std::printf("planned without slip: ");
  const Laps without = drive(*course, line, WithoutSlip{});
  std::printf("planned with the network: ");
  const Laps learned = drive(*course, line, Learned{slalom::Mlp<6, 3>{slalom::load_mlp(argv[2])}});
  return learned.finished >= 18 && learned.distance < 0.6 * without.distance ? 0 : 1;
} catch (const std::exception& error) {  // a file that cannot be read, or is damaged
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
