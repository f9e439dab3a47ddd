#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slalom/solvers/controllers.hpp"
#include "slalom/solvers/registry.hpp"

/// Default options need no temperature and no variance: plans depend neither on the unit of the costs nor on
/// those of the inputs.
namespace slalom {
namespace {

/// A robot that passes a disc. Its costs are multiplied by `cost`, its inputs are in units of `speed_unit`
/// and `turn_unit`.
struct Robot {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad
  };
  static constexpr int inputs = 2;
  double dt = 0.1;  // s
  double cost = 1, speed_unit = 1, turn_unit = 1;

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const T way = T(dt) * (T(speed_unit) * u[0]);
    return {s.x + way * cosine, s.y + way * sine, s.yaw + T(dt) * (T(turn_unit) * u[1])};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    const mask_t<T> hit = square(s.x - T(2)) + square(s.y) < T(0.5);
    const T turn = T(turn_unit) * u[1];
    return {T(cost) * (hypot(s.x - T(4), s.y) + T(0.1) * turn * turn + select(hit, T(100), T(0))), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(cost) * (T(10) * hypot(s.x - T(4), s.y));
  }
};

/// The inputs of some solves in a closed loop, in m/s and rad/s.
std::vector<double> driven(const char* method, const Robot& robot) {
  SolverOptions options = solver_options(method);
  *options.find<int>("horizon") = 20;
  *options.find<int>("samples") = 128;
  *options.find<PerInput>("input_min") = PerInput({-0.2 / robot.speed_unit, -1.5 / robot.turn_unit});
  *options.find<PerInput>("input_max") = PerInput({1 / robot.speed_unit, 1.5 / robot.turn_unit});
  Controller controller(robot, options);
  Robot::State<double> x{0, 0, 0};
  std::vector<double> inputs;
  for (int k = 0; k < 6; ++k) {
    const auto plan = controller.solve(x, {.elapsed = robot.dt});
    for (const auto& u : plan.inputs) {
      inputs.push_back(u[0] * robot.speed_unit);
      inputs.push_back(u[1] * robot.turn_unit);
    }
    x = robot.step(x, plan.inputs[0]);
  }
  return inputs;
}

class ScaleFree : public ::testing::TestWithParam<const char*> {};

TEST_P(ScaleFree, CostsAndInputsInOtherUnitsGiveTheSamePlans) {
  const std::vector<double> expected = driven(GetParam(), {});
  for (const int k : {-20, -7, -1, 1, 13, 20}) {
    EXPECT_EQ(driven(GetParam(), {.cost = std::ldexp(1, k)}), expected) << "2^" << k;
    EXPECT_EQ(driven(GetParam(), {.speed_unit = std::ldexp(1, k), .turn_unit = std::ldexp(1, -k)}), expected)
        << "2^" << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, ScaleFree,
                         ::testing::Values("mppi", "svg_mppi", "cem", "icem", "dial_mpc"));

/// With the defaults, `mppi` swings README's pendulum up from hanging down.
struct Pendulum {
  template <class T>
  struct State {
    T angle, rate;
  };
  static constexpr int inputs = 1;
  double dt = 0.02;
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    const T rate = x.rate + T(dt) * (T(9.81) * sin(x.angle) + u[0]);
    return {x.angle + T(dt) * rate, rate};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>& u) const {
    return T(1) - cos(x.angle) + T(0.01) * (x.rate * x.rate + u[0] * u[0]);
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(10) * (T(1) - cos(x.angle));
  }
};

TEST_P(ScaleFree, DefaultsSwingThePendulumUp) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SolverOptions options = solver_options(GetParam());
    *options.find<int>("horizon") = 60;
    *options.find<PerInput>("input_min") = -5;
    *options.find<PerInput>("input_max") = 5;
    *options.find<std::uint64_t>("seed") = seed;
    Controller controller(Pendulum{}, options);
    Pendulum::State<double> x{3.14159, 0};
    for (int k = 0; k < 300; ++k) {
      const auto plan = controller.solve(x, {.elapsed = 0.02});
      x = controller.problem().step(x, plan.inputs[0]);
    }
    EXPECT_GT(std::cos(x.angle), 0.95) << seed;
  }
}

/// A stirred tank with an exothermic reaction, cooled by a jacket. In some samples it runs away: their costs
/// exceed those of the others by 25 orders of magnitude, or are not finite.
struct Reactor {
  template <class T>
  struct State {
    T concentration, temperature;  // mol/l, K
  };
  static constexpr int inputs = 1;  // temperature of the jacket, K
  double dt = 0.05;                 // min
  double input_min = 280, input_max = 370;
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    State<T> now = x;
    for (int i = 0; i < 5; ++i) {
      const T reaction = T(7.2e10) * exp(T(-8750) / now.temperature) * now.concentration;
      const T heat = T(350) - now.temperature + T(209.2) * reaction + T(2.092) * (u[0] - now.temperature);
      now = {now.concentration + T(dt / 5) * (T(1) - now.concentration - reaction),
             now.temperature + T(dt / 5) * heat};
    }
    return now;
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>&) const {
    return square((x.concentration - T(0.5)) / T(0.05)) + square((x.temperature - T(350)) / T(5));
  }
};

TEST_P(ScaleFree, SamplesThatDivergeDoNotHideTheOthers) {
  SolverOptions options = solver_options(GetParam());
  *options.find<int>("horizon") = 30;
  Controller controller(Reactor{}, options);
  Reactor::State<double> x{0.9, 305};
  for (int k = 0; k < 120; ++k)
    x = controller.problem().step(x, controller.solve(x, {.elapsed = 0.05}).inputs[0]);
  EXPECT_NEAR(x.concentration, 0.5, 0.1);
  EXPECT_NEAR(x.temperature, 350, 5);
}

}  // namespace
}  // namespace slalom
