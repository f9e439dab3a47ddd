// Somebody steps in front of a delivery robot. The samples accelerate smoothly, with a standard deviation of
// 1 m/s^2, so hardly one brakes fully, and the robot may brake too late. A brake that is proposed beside the
// samples is there at once. While nobody is in the way, it costs too much to count.

#include <cstdio>

#include <slalom/slalom.hpp>

#include "seeds.hpp"

struct Robot {
  template <class T>
  struct State {
    T position, speed;  // m, m/s
  };
  static constexpr int inputs = 1;       // m/s^2
  double dt = 0.05;                      // s
  double input_min = -6, input_max = 2;  // m/s^2
  double cruising_speed = 6;             // m/s
  double person = 1000;                  // m, place of the person in the way
  double clearance = 0.5;                // m

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 1>& u) const {
    const T speed = slalom::max(x.speed + T(dt) * u[0], T(0));  // it does not drive back
    return {x.position + T(dt) * speed, speed};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& x, const slalom::Input<T, 1>& u) const {
    const slalom::mask_t<T> hit = collides(x);
    const T effort = T(0.05) * u[0] * u[0];
    return {
        T(dt) * (slalom::square(x.speed - T(cruising_speed)) + effort) + slalom::select(hit, T(100), T(0)),
        hit};
  }

  /// Whether the robot collides with the person.
  template <class T>
  slalom::mask_t<T> collides(const State<T>& x) const {
    return x.position > T(person - clearance);
  }
};

/// Brakes until the robot stands.
slalom::Input<double, 1> brake(const Robot::State<double>& x, int /*step*/) {
  return {{x.speed > 0 ? -6.0 : 0.0}};
}

/// Whether the robot stands in time for a person who steps into its way 4 m ahead. It needs 3 m to stop.
template <class Controller>
bool stops(Controller controller, bool with_brake) {
  slalom::Proposals proposals{controller, 1};
  Robot& robot = controller.problem();
  Robot::State<double> x{0, robot.cruising_speed};
  for (int k = 0; k < 100; ++k) {
    if (k == 20) robot.person = x.position + 4;
    proposals.clear();
    if (with_brake) proposals.follow(controller, x, brake);
    const auto plan = controller.solve(x, {.elapsed = robot.dt, .proposals = proposals});
    x = robot.step(x, plan.inputs[0]);
    if (robot.collides(x)) return false;
    if (k > 20 && x.speed == 0) return true;
  }
  return false;
}

int main() {
  const auto mppi = [](auto seed) {
    return slalom::Mppi{Robot{}, {.horizon = 40, .samples = 512, .control_cost_discount = 1, .seed = seed}};
  };
  const auto svg_mppi = [](auto seed) {
    return slalom::SvgMppi{Robot{}, {.horizon = 40, .samples = 512, .seed = seed}};
  };
  const int alone = succeeded([&](auto seed) { return stops(mppi(seed), false); });
  const int braked = succeeded([&](auto seed) { return stops(mppi(seed), true); });
  const int svg_alone = succeeded([&](auto seed) { return stops(svg_mppi(seed), false); });
  const int svg_braked = succeeded([&](auto seed) { return stops(svg_mppi(seed), true); });
  std::printf("the robot stops in time: mppi %d of 20 seeds, with a brake as proposal %d\n", alone, braked);
  std::printf("svg_mppi %d of 20 seeds, with a brake as proposal %d\n", svg_alone, svg_braked);
  return braked == 20 && svg_braked == 20 && alone < 20 ? 0 : 1;
}
