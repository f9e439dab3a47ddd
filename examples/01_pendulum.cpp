// A pendulum whose motor is too weak to lift it directly: it must swing up.

#include <cmath>
#include <numbers>

#include <slalom/slalom.hpp>

#include "seeds.hpp"

struct Pendulum {  // a mass of 1 kg on a rod of 1 m; the angle is measured from upright
  template <class T>
  struct State {
    T angle, rate;  // rad, rad/s
  };
  static constexpr int inputs = 1;  // torque, N m
  double dt = 0.02;                 // s

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 1>& u) const {
    const T rate = x.rate + T(dt) * (T(9.81) * slalom::sin(x.angle) + u[0]);
    return {x.angle + T(dt) * rate, rate};
  }
  template <class T>
  T stage_cost(const State<T>& x, const slalom::Input<T, 1>& u) const {
    return T(dt) * (T(10) * (T(1) - slalom::cos(x.angle)) + T(0.1) * x.rate * x.rate + T(0.01) * u[0] * u[0]);
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    const T energy =
        T(0.5) * x.rate * x.rate + T(9.81) * (slalom::cos(x.angle) - T(1));  // 0 when it is upright
    return energy * energy;
  }
};

/// Whether the pendulum is upright 6 s after it started hanging down.
template <class Controller>
bool stands(Controller controller) {
  const Pendulum& pendulum = controller.problem();
  Pendulum::State<double> x{std::numbers::pi, 0};
  for (double t = 0; t < 6; t += pendulum.dt) {
    const auto plan = controller.solve(x, {.elapsed = pendulum.dt});
    if (plan.status != slalom::Status::ok) return false;
    x = pendulum.step(x, plan.inputs[0]);
  }
  return std::cos(x.angle) > 0.995 && std::abs(x.rate) < 0.5;
}

int main() {
  const int mppi = succeeded([](auto seed) {
    return stands(slalom::Mppi{Pendulum{},
                               {.horizon = 60,
                                .samples = 1024,
                                .temperature = 0.2,
                                .variance = 4,
                                .input_min = {-5},
                                .input_max = {5},
                                .seed = seed}});
  });
  const int svg_mppi = succeeded([](auto seed) {
    return stands(slalom::SvgMppi{Pendulum{},
                                  {.horizon = 60,
                                   .samples = 1024,
                                   .temperature = 0.2,
                                   .input_min = {-5},
                                   .input_max = {5},
                                   .seed = seed}});
  });
  return report("the pendulum is upright", mppi, svg_mppi, 20);
}
