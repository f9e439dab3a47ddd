#include <numbers>

#include "task.hpp"

namespace slalom::suite {

namespace {

/// A hovercraft with a main thruster, a side thruster and a rudder flies through the gap between two discs.
struct Hovercraft {
  template <class T>
  struct State {
    T x, y, yaw, speed_x, speed_y, rate;  // m, m, rad, m/s, m/s, rad/s
  };
  static constexpr int inputs = 3;  // m/s^2 ahead, m/s^2 to the left, rad/s^2
  double dt = 0.05;                 // s
  double goal_x = 6, goal_y = 0;    // m
  double disc_x = 3, disc_y = 0.9;  // m, the second disc is at -disc_y
  double radius = 0.65;             // m, of a disc and the hovercraft together
  double drag = 0.2;                // 1/s

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 3>& u) const {
    T s, c;
    sin_cos(x.yaw, s, c);
    const T speed_x = x.speed_x + T(dt) * (c * u[0] - s * u[1] - T(drag) * x.speed_x);
    const T speed_y = x.speed_y + T(dt) * (s * u[0] + c * u[1] - T(drag) * x.speed_y);
    const T rate = x.rate + T(dt) * (u[2] - T(drag) * x.rate);
    return {x.x + T(dt) * speed_x, x.y + T(dt) * speed_y, x.yaw + T(dt) * rate, speed_x, speed_y, rate};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 3>& u) const {
    const mask_t<T> hit = collides(x);
    const T effort = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    return {T(dt) * (distance(x) + T(0.01) * effort) + select(hit, T(100), T(0)), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(5) * distance(x) + x.speed_x * x.speed_x + x.speed_y * x.speed_y + T(0.2) * x.rate * x.rate;
  }
  template <class T>
  T distance(const State<T>& x) const {
    return sqrt(square(x.x - T(goal_x)) + square(x.y - T(goal_y)));
  }
  template <class T>
  mask_t<T> collides(const State<T>& x) const {
    return square(x.x - T(disc_x)) + square(abs(x.y) - T(disc_y)) < T(radius * radius);
  }
};

/// Three robots on a circle change places; each has two accelerations.
struct Swap {
  static constexpr int robots = 3;
  template <class T>
  struct State {
    T x[robots], y[robots], speed_x[robots], speed_y[robots];  // m, m/s
  };
  static constexpr int inputs = 2 * robots;                               // m/s^2
  double dt = 0.1;                                                        // s
  double apart = 0.6;                                                     // m, least distance between centres
  std::array<double, robots> goal_x{-2, 1, 1}, goal_y{0, -1.732, 1.732};  // m

  template <class T>
  State<T> step(const State<T>& s, const Input<T, inputs>& u) const {
    State<T> next;
    for (int i = 0; i < robots; ++i) {
      next.speed_x[i] = s.speed_x[i] + T(dt) * u[2 * i];
      next.speed_y[i] = s.speed_y[i] + T(dt) * u[2 * i + 1];
      next.x[i] = s.x[i] + T(dt) * next.speed_x[i];
      next.y[i] = s.y[i] + T(dt) * next.speed_y[i];
    }
    return next;
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, inputs>& u) const {
    const mask_t<T> hit = collides(s);
    T cost = T(0);
    for (int i = 0; i < robots; ++i) {
      cost += distance(s, i) + T(0.02) * (square(u[2 * i]) + square(u[2 * i + 1]));
    }
    return {T(dt) * cost + select(hit, T(100), T(0)), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    T cost = T(0);
    for (int i = 0; i < robots; ++i)
      cost += T(5) * distance(s, i) + T(0.5) * (square(s.speed_x[i]) + square(s.speed_y[i]));
    return cost;
  }
  template <class T>
  T distance(const State<T>& s, int i) const {
    return sqrt(square(s.x[i] - T(goal_x[i])) + square(s.y[i] - T(goal_y[i])));
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    mask_t<T> hit(false);
    for (int i = 0; i < robots; ++i)
      for (int j = 0; j < i; ++j)
        hit = hit | (square(s.x[i] - s.x[j]) + square(s.y[i] - s.y[j]) < T(apart * apart));
    return hit;
  }
};

/// A mass point that follows a goal; a disc stands between them again and again.
struct Chase : PointMass {
  double goal_x = 2, goal_y = 0;  // m, at the start of the rollout
  double way_x = 0, way_y = 0;    // m/s, of the goal
  double radius = 0.8;            // m, of the disc at the origin

  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u, int k) const {
    const mask_t<T> hit = collides(s);
    return {T(dt) * (T(4) * distance(s, k * dt) + T(0.02) * (u[0] * u[0] + u[1] * u[1])) +
                select(hit, T(100), T(0)),
            hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(0.1) * (square(s.speed_x) + square(s.speed_y));
  }
  template <class T>
  T distance(const State<T>& s, double ahead) const {
    return sqrt(square(s.x - T(goal_x + ahead * way_x)) + square(s.y - T(goal_y + ahead * way_y)));
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    return square(s.x) + square(s.y) < T(radius * radius);
  }
};

/// A mass point whose costs are only steps: rings around the goal, and a toll for patches of bad ground.
struct Rings : PointMass {
  double goal_x = 5, goal_y = 0;  // m

  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    T cost = T(0.002) * (u[0] * u[0] + u[1] * u[1]);
    const T squared = square_distance(s);
    for (int ring = 1; ring <= 24; ++ring) cost += select(squared > T(0.0625 * ring * ring), T(0.1), T(0));
    return cost + select(on_bad_ground(s), T(3), T(0)) +
           select(square(s.speed_x) + square(s.speed_y) > T(4), T(1), T(0));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(5) * stage_cost(s, Input<T, 2>{{T(0), T(0)}}) +
           select(square(s.speed_x) + square(s.speed_y) > T(0.25), T(3), T(0));
  }
  template <class T>
  T square_distance(const State<T>& s) const {
    return square(s.x - T(goal_x)) + square(s.y - T(goal_y));
  }
  template <class T>
  mask_t<T> on_bad_ground(const State<T>& s) const {
    return (abs(s.x - T(2.5)) < T(0.5)) && (abs(s.y) < T(1.2));
  }
};

constexpr int flight_steps = 120, chase_steps = 160, ring_steps = 70;
/// Time in which the goal of `Chase` goes once to and fro, s.
constexpr double chase_period = 8;

/// Moves the goal, for the solve at step k: on a line through the disc.
void move_goal(Chase& p, const Chase::State<double>&, int k) {
  const double turning = 2 * std::numbers::pi / chase_period, phase = turning * k * p.dt;
  p.goal_x = 2.2 * std::cos(phase);
  p.goal_y = 0.2 * std::sin(phase);
  p.way_x = -2.2 * turning * std::sin(phase);
  p.way_y = 0.2 * turning * std::cos(phase);
}

Verdict chase(const Chase& p, const Chase::State<double>& s, int k) {
  if (p.collides(s)) return Verdict::failed;
  // The goal turns at its ends once per half period; it must be met there.
  const int half = static_cast<int>(chase_period / 2 / p.dt);
  if ((k + 1) % half == half / 8 && p.distance(s, p.dt) > 0.5) return Verdict::failed;
  return at_end(k, chase_steps, true);
}

}  // namespace

void add_plane_tasks(std::vector<Task>& tasks) {
  add(tasks, "hovercraft_gap", Ways::one, 40, std::vector<TaskInput>(3, {-3, 3}),
      closed_loop(Hovercraft{}, {0, 0.5, 0, 0, 0, 0}, flight_steps, [](const auto& p, const auto& x, int k) {
        return p.collides(x) ? Verdict::failed : at_end(k, flight_steps, p.distance(x) < 0.3);
      }));
  add(tasks, "three_robots_swap", Ways::several, 30, std::vector<TaskInput>(6, {-2, 2}),
      closed_loop(Swap{}, {{2, -1, -1}, {0, 1.732, -1.732}, {0, 0, 0}, {0, 0, 0}}, 80,
                  [](const auto& p, const auto& s, int) {
                    return reached(p.collides(s),
                                   std::max({p.distance(s, 0), p.distance(s, 1), p.distance(s, 2)}) < 0.4);
                  }));
  add(tasks, "moving_goal", Ways::several, 25, std::vector<TaskInput>(2, {-4, 4}),
      closed_loop(Chase{}, {2, 0, 0, 0}, chase_steps, chase, move_goal));
  add(tasks, "steps_of_cost", Ways::several, 30, std::vector<TaskInput>(2, {-2, 2}),
      closed_loop(Rings{}, {0, 0, 0, 0}, ring_steps, [](const auto& p, const auto& s, int k) {
        return p.on_bad_ground(s) ? Verdict::failed : at_end(k, ring_steps, p.square_distance(s) < 0.25);
      }));
}

}  // namespace slalom::suite
