// A hovercraft flies through the gap between two discs. It pushes ahead and to the side, and turns. The best
// guide is many standard deviations away from the last solution in most solves, and samples around it keep
// their weights.

#include <cmath>

#include <slalom/slalom.hpp>

#include "seeds.hpp"

struct Hovercraft {
  template <class T>
  struct State {
    T x, y, yaw, speed_x, speed_y, rate;  // m, m, rad, m/s, m/s, rad/s
  };
  static constexpr int inputs = 3;  // m/s^2 ahead, m/s^2 to the left, rad/s^2
  double dt = 0.05;                 // s
  double input_min = -3, input_max = 3;
  double goal_x = 6;        // m, on the axis between the discs
  double disc_x = 3;        // m
  double disc_y = 0.9;      // m, the second disc is at -disc_y
  double clearance = 0.65;  // m, radius of a disc and of the hovercraft together

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 3>& u) const {
    T s, c;
    slalom::sin_cos(x.yaw, s, c);
    const T drag(0.2);  // 1/s
    const T speed_x = x.speed_x + T(dt) * (c * u[0] - s * u[1] - drag * x.speed_x);
    const T speed_y = x.speed_y + T(dt) * (s * u[0] + c * u[1] - drag * x.speed_y);
    const T rate = x.rate + T(dt) * (u[2] - drag * x.rate);
    return {x.x + T(dt) * speed_x, x.y + T(dt) * speed_y, x.yaw + T(dt) * rate, speed_x, speed_y, rate};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& x, const slalom::Input<T, 3>& u) const {
    const T effort = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    const slalom::mask_t<T> hit = collides(x);
    return {T(dt) * (distance(x) + T(0.01) * effort) + slalom::select(hit, T(100), T(0)), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(5) * distance(x) + x.speed_x * x.speed_x + x.speed_y * x.speed_y + T(0.2) * x.rate * x.rate;
  }

  /// To the goal, m.
  template <class T>
  T distance(const State<T>& x) const {
    return slalom::hypot(x.x - T(goal_x), x.y);
  }
  /// Whether it collides with a disc.
  template <class T>
  slalom::mask_t<T> collides(const State<T>& x) const {
    return slalom::hypot(x.x - T(disc_x), slalom::abs(x.y) - T(disc_y)) < T(clearance);
  }
};

/// Whether the hovercraft is within 0.3 m of its goal after 6 s, without a collision and with plans that
/// follow more than single samples.
template <class Controller>
bool arrives(Controller controller) {
  const Hovercraft& craft = controller.problem();
  Hovercraft::State<double> x{0, 0.5, 0, 0, 0, 0};
  bool few = false;
  for (int k = 0; k < 120; ++k) {
    const auto plan = controller.solve(x, {.elapsed = craft.dt});
    few = few || plan.stats.has_few_samples();
    x = craft.step(x, plan.inputs[0]);
    if (craft.collides(x)) return false;
  }
  return craft.distance(x) < 0.3 && !few;
}

int main() {
  int failed = 0;
  for (const double temperature : {1.0, 10.0}) {
    const int mppi = succeeded([&](auto seed) {
      return arrives(slalom::Mppi{
          Hovercraft{},
          {.horizon = 40, .samples = 1024, .temperature = temperature, .variance = 2.25, .seed = seed}});
    });
    const int svg_mppi = succeeded([&](auto seed) {
      return arrives(slalom::SvgMppi{Hovercraft{},
                                     {.horizon = 40,
                                      .samples = 1024,
                                      .temperature = temperature,
                                      .guides = {.step = 0.56,
                                                 .variance = 1.12,
                                                 .gradient_variance = 1.12,
                                                 .gradient_temperature = temperature,
                                                 .restart_variance = 2.25},
                                      .variance_min = 0.56,
                                      .variance_max = 2.25,
                                      .seed = seed}});
    });
    std::printf("temperature %g, ", temperature);
    failed += report("the hovercraft arrives", mppi, svg_mppi, 18, true);
  }
  return failed;
}
