#include <cmath>

#include "slalom/core/gravity.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "task.hpp"

/// Tasks that are solved by exactness: a state is held within a bound in the whole last third of a run.
namespace slalom::suite {

namespace {

Verdict holds(int k, int steps, double error, double bound) {
  if (3 * k < 2 * steps) return Verdict::running;
  return error > bound ? Verdict::failed : at_end(k, steps, true);
}

/// A drone in the plane with two rotors, which flies to a place 6 m away and stays there.
struct PlanarDrone {
  template <class T>
  struct State {
    T x, y, tilt, speed_x, speed_y, rate;  // m, rad
  };
  static constexpr int inputs = 2;                 // thrusts, N
  double dt = 0.05, arm = 0.2, inertia = 0.05;     // s, m, kg m^2; its mass is 1 kg
  static constexpr double goal_x = 6, goal_y = 1;  // m

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.tilt, sine, cosine);
    const T thrust = u[0] + u[1], rate = s.rate + T(dt * arm / inertia) * (u[1] - u[0]);
    const T speed_x = s.speed_x - T(dt) * thrust * sine;
    const T speed_y = s.speed_y + T(dt) * (thrust * cosine - T(gravity));
    return {s.x + T(dt) * speed_x, s.y + T(dt) * speed_y, s.tilt + T(dt) * rate, speed_x, speed_y, rate};
  }
  template <class T>
  T distance2(const State<T>& s) const {
    return square(s.x - T(goal_x)) + square(s.y - T(goal_y));
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    const T motion = square(s.speed_x) + square(s.speed_y) + square(s.rate);
    const T effort = square(u[0] - T(gravity / 2)) + square(u[1] - T(gravity / 2));
    return T(dt) * (distance2(s) + T(0.3) * square(s.tilt) + T(0.05) * motion + T(0.005) * effort);
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(5) * distance2(s) + T(0.5) * (square(s.speed_x) + square(s.speed_y)) + square(s.tilt);
  }
};

/// A car that is steered along a line by the changes of its acceleration and of its steering angle.
struct SmoothCar {
  template <class T>
  struct State {
    T x, y, yaw, speed, acceleration, steer;  // m, rad
  };
  static constexpr int inputs = 2;                // m/s^3, rad/s
  double dt = 0.1, wheelbase = 2.8, wanted = 10;  // s, m, m/s

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    return {s.x + T(dt) * s.speed * cosine,
            s.y + T(dt) * s.speed * sine,
            s.yaw + T(dt / wheelbase) * s.speed * tan(s.steer),
            s.speed + T(dt) * s.acceleration,
            s.acceleration + T(dt) * u[0],
            clamp(s.steer + T(dt) * u[1], T(-0.5), T(0.5))};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    const T effort = T(0.1) * square(u[0]) + T(10) * square(u[1]);
    return square(s.y) + square(s.speed - T(wanted)) + T(5) * square(s.yaw) + effort;
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(10) * (square(s.y) + square(s.speed - T(wanted)) + square(s.yaw));
  }
};

/// A spacecraft that turns about three axes by reaction wheels, and points its body along the axes of space.
struct Spacecraft {
  template <class T>
  struct State {
    T w, x, y, z;  // unit quaternion, from the body's axes to those of space
    T rate[3];     // rad/s, body
  };
  static constexpr int inputs = 3;                       // torques, N m
  static constexpr double inertia[3] = {0.9, 1.1, 0.7};  // kg m^2
  double dt = 0.5;                                       // s

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 3>& u) const {
    State<T> n = s;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const T gyroscopic = T(inertia[j] - inertia[k]) * s.rate[j] * s.rate[k];
      n.rate[i] = s.rate[i] + T(dt / inertia[i]) * (u[i] + gyroscopic);
    }
    const T a = T(dt / 2) * n.rate[0], b = T(dt / 2) * n.rate[1], c = T(dt / 2) * n.rate[2];
    n.w = s.w - a * s.x - b * s.y - c * s.z;
    n.x = s.x + a * s.w + c * s.y - b * s.z;
    n.y = s.y + b * s.w - c * s.x + a * s.z;
    n.z = s.z + c * s.w + b * s.x - a * s.y;
    const T length = sqrt(square(n.w) + square(n.x) + square(n.y) + square(n.z));
    n.w = n.w / length, n.x = n.x / length, n.y = n.y / length, n.z = n.z / length;
    return n;
  }
  template <class T>
  T turning(const State<T>& s) const {
    return square(s.rate[0]) + square(s.rate[1]) + square(s.rate[2]);
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 3>& u) const {
    const T effort = square(u[0]) + square(u[1]) + square(u[2]);
    return T(dt) * (T(1) - square(s.w) + turning(s) + T(20) * effort);
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(20) * (T(1) - square(s.w)) + T(100) * turning(s);
  }
};

}  // namespace

std::vector<Task> holding_tasks() {
  std::vector<Task> tasks;
  const auto drone = [](int steps) {
    return [steps](const PlanarDrone& p, const PlanarDrone::State<double>& x, int k) {
      return holds(k, steps, std::sqrt(p.distance2(x)), 0.01);  // m
    };
  };
  add(tasks, "drone", Ways::one, 30, {{0, 12}, {0, 12}},
      closed_loop(PlanarDrone{}, {0, 0, 0, 0, 0, 0}, 200, drone(200)));
  add(tasks, "agile_drone", Ways::one, 50, {{0, 12}, {0, 12}},
      closed_loop(PlanarDrone{.dt = 0.02, .arm = 0.1, .inertia = 0.005}, {0, 0, 0, 0, 0, 0}, 500,
                  drone(500)));
  add(tasks, "pole", Ways::one, 60, {{-10, 10}},
      closed_loop(problems::CartPole{}, {0, 0, 0.2, 0}, 400,
                  [](const auto&, const auto& x, int k) { return holds(k, 400, std::abs(x.angle), 0.01); }));
  add(tasks, "smooth_car", Ways::one, 30, {{-2, 2}, {-0.2, 0.2}},
      closed_loop(SmoothCar{}, {0, 2, 0.1, 5, 0, 0}, 300, [](const SmoothCar& p, const auto& x, int k) {
        return holds(k, 300, std::max(std::abs(x.y), std::abs(x.speed - p.wanted)), 0.01);  // m, m/s
      }));
  add(tasks, "spacecraft", Ways::one, 40, {{-0.02, 0.02}, {-0.02, 0.02}, {-0.02, 0.02}},
      closed_loop(Spacecraft{}, {0.5, 0.5, -0.5, 0.5, {0.06, -0.06, 0.06}}, 300,
                  [](const Spacecraft&, const auto& x, int k) {
                    return holds(k, 300, 2 * std::sqrt(std::max(0.0, 1 - x.w * x.w)), 0.01);  // rad
                  }));
  return tasks;
}

}  // namespace slalom::suite
