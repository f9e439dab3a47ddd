// A mass point follows a goal that goes to and fro behind a disc. The goal is a part of the state: rollouts
// know where it will be if it keeps its speed, and every solve starts from where it is.

#include <cmath>
#include <numbers>

#include <slalom/slalom.hpp>

#include "seeds.hpp"

struct Chase {
  template <class T>
  struct State {
    T x, y, speed_x, speed_y;                      // m, m/s
    T goal_x, goal_y, goal_speed_x, goal_speed_y;  // m, m/s
  };
  static constexpr int inputs = 2;  // m/s^2
  double dt = 0.1;                  // s
  double input_min = -4, input_max = 4;
  double radius = 0.8;  // m, of the disc at the origin

  template <class T>
  State<T> step(const State<T>& s, const slalom::Input<T, 2>& u) const {
    const T speed_x = s.speed_x + T(dt) * u[0], speed_y = s.speed_y + T(dt) * u[1];
    return {s.x + T(dt) * speed_x,
            s.y + T(dt) * speed_y,
            speed_x,
            speed_y,
            s.goal_x + T(dt) * s.goal_speed_x,
            s.goal_y + T(dt) * s.goal_speed_y,
            s.goal_speed_x,
            s.goal_speed_y};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& s, const slalom::Input<T, 2>& u) const {
    const slalom::mask_t<T> hit = collides(s);
    return {T(dt) * (T(4) * distance(s) + T(0.02) * (u[0] * u[0] + u[1] * u[1])) +
                slalom::select(hit, T(100), T(0)),
            hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(0.1) * (s.speed_x * s.speed_x + s.speed_y * s.speed_y);
  }

  /// To the goal, m.
  template <class T>
  T distance(const State<T>& s) const {
    return slalom::hypot(s.x - s.goal_x, s.y - s.goal_y);
  }
  /// Whether it collides with the disc.
  template <class T>
  slalom::mask_t<T> collides(const State<T>& s) const {
    return slalom::hypot(s.x, s.y) < T(radius);
  }
};

/// Moves the goal to its place at a time (s): it goes to and fro in 8 s, on both sides of the disc.
void move_goal(Chase::State<double>& s, double time) {
  const double turning = 2 * std::numbers::pi / 8;  // rad/s
  const double cosine = std::cos(turning * time), sine = std::sin(turning * time);
  s.goal_x = 2.2 * cosine, s.goal_speed_x = -2.2 * turning * sine;
  s.goal_y = 0.2 * sine, s.goal_speed_y = 0.2 * turning * cosine;
}

/// Whether the point is within 0.5 m of the goal, 0.5 s after each of its turns, and never hits the disc in
/// 16 s.
template <class Controller>
bool follows(Controller controller) {
  const Chase& chase = controller.problem();
  Chase::State<double> s{2, 0, 0, 0, 0, 0, 0, 0};
  for (int k = 1; k <= 160; ++k) {
    move_goal(s, (k - 1) * chase.dt);
    s = chase.step(s, controller.solve(s, {.elapsed = chase.dt}).inputs[0]);
    if (chase.collides(s) || (k % 40 == 5 && chase.distance(s) > 0.5)) return false;
  }
  return true;
}

int main() {
  const int mppi = succeeded([](auto seed) {
    return follows(slalom::Mppi{
        Chase{}, {.horizon = 25, .samples = 1024, .temperature = 1, .variance = 2.25, .seed = seed}});
  });
  const int svg_mppi = succeeded([](auto seed) {
    return follows(slalom::SvgMppi{Chase{},
                                   {.horizon = 25,
                                    .samples = 512,
                                    .temperature = 1,
                                    .guides = {.count = 4,
                                               .step = 0.56,
                                               .variance = 1.12,
                                               .gradient_samples = 12,
                                               .gradient_variance = 1.12,
                                               .restart_variance = 2.25},
                                    .variance_min = 0.56,
                                    .variance_max = 2.25,
                                    .seed = seed}});
  });
  return report("the point follows the goal", mppi, svg_mppi, 18, true);
}
