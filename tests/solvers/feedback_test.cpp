#include "slalom/solvers/feedback.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/slalom.hpp"
#include "support/allocations.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

/// x' = a x + b u with the cost q x^2 + r u^2, ended by p x^2.
struct Scalar {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  double dt = 0.1, a = 1.1, b = 0.5, q = 2, r = 3, p = 0;

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    return {T(a) * s.x + T(b) * u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    return T(q) * s.x * s.x + T(r) * u[0] * u[0];
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(p) * s.x * s.x;
  }
};

TEST(Feedback, IsTheClosedFormOfTheScalarRegulator) {
  Scalar problem;
  // The algebraic Riccati equation p = q + a^2 p - (a b p)^2 / (r + b^2 p) is quadratic in p.
  const double a = problem.a, b = problem.b, q = problem.q, r = problem.r;
  const double half = (r - a * a * r - b * b * q) / (2 * b * b);
  const double p = -half + std::sqrt(half * half + q * r / (b * b)), k = -a * b * p / (r + b * b * p);
  problem.p = p;
  Mppi controller{problem, {.horizon = 30, .samples = 64}};
  Feedback feedback{controller};
  const auto plan = controller.solve({1});
  ASSERT_TRUE(feedback.update(controller, plan));
  for (int step = 0; step < 30; ++step) EXPECT_NEAR(feedback.gain(step)[0], k, 1e-8) << step;
  EXPECT_FALSE(feedback.has_kink());
  const double u = plan.inputs[3][0];
  EXPECT_NEAR(feedback.input_at(0.35, {0.5 * (plan.states[3].x + plan.states[4].x) + 0.2})[0], u + 0.2 * k,
              1e-8);
  EXPECT_DOUBLE_EQ(feedback.input_at(0.3, plan.states[3])[0], u);
}

/// A double integrator with two inputs, products of state and inputs in its cost, and a horizon of few steps.
struct Coupled {
  template <class T>
  struct State {
    T place, speed;
  };
  static constexpr int inputs = 2;
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u, int k) const {
    return {s.place + T(0.2) * s.speed, s.speed + T(0.2 + 0.1 * k) * u[0] - T(0.3) * u[1]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 2>& u, int k) const {
    return T(1 + k) * s.place * s.place + T(0.1) * s.speed * s.speed + T(0.2) * s.speed * u[0] +
           T(0.5) * u[0] * u[0] + T(0.1) * u[0] * u[1] + T(0.8) * u[1] * u[1] + s.place;
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(5) * square(s.place) + T(0.5) * square(s.speed);
  }
};

/// The inputs that minimise a quadratic cost over `steps` steps, from its values at unit vectors.
Eigen::VectorXd best_inputs(const Coupled& problem, Coupled::State<double> x, int steps) {
  const int n = 2 * steps;
  const auto cost = [&](int i, int j, double size) {
    std::vector<Input<double, 2>> u(static_cast<std::size_t>(steps), Input<double, 2>{});
    for (const int input : {i, j}) u[input / 2].value[input % 2] += size;
    return predict(problem, x, u.data(), steps, nullptr).value;
  };
  const double rest = cost(0, 0, 0);
  Eigen::MatrixXd hessian(n, n);
  Eigen::VectorXd gradient(n);
  for (int i = 0; i < n; ++i) {
    const double up = cost(i, i, 0.5), down = cost(i, i, -0.5);  // moves input i by 1
    gradient[i] = -0.5 * (up - down);
    hessian(i, i) = up + down - 2 * rest;
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      hessian(i, j) = hessian(j, i) =
          0.5 * (cost(i, j, 1) + cost(i, j, -1) - 2 * rest - hessian(i, i) - hessian(j, j));
  return hessian.partialPivLu().solve(gradient);
}

TEST(Feedback, IsTheDerivativeOfTheBestInputsOfALinearQuadraticProblem) {
  const int steps = 5;
  const Coupled problem;
  Mppi controller{problem, {.horizon = steps, .samples = 64}};
  Feedback feedback{controller};
  ASSERT_TRUE(feedback.update(controller, controller.solve({1, -0.5})));
  const auto at_rest = best_inputs(problem, {0, 0}, steps);
  const auto moved = best_inputs(problem, {1, 0}, steps), fast = best_inputs(problem, {0, 1}, steps);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(feedback.gain(0)[2 * i], moved[i] - at_rest[i], 1e-8);
    EXPECT_NEAR(feedback.gain(0)[2 * i + 1], fast[i] - at_rest[i], 1e-8);
  }
}

TEST(Feedback, HoldsAnUnstablePendulumBetweenSolves) {
  const problems::Pendulum problem;
  SvgMppi controller{problem, {.horizon = 60, .input_min = {-5}, .input_max = {5}}};
  Feedback feedback{controller};
  const auto plan = controller.solve({0.05, 0});
  ASSERT_TRUE(feedback.update(controller, plan));
  problems::Pendulum::State<double> open{0.1, 0.1}, closed = open;
  for (int k = 0; k < 50; ++k) {
    open = problem.step(open, plan.inputs[k]);
    closed = problem.step(closed, feedback.input_at(k * problem.dt, closed));
  }
  EXPECT_GT(std::abs(open.angle - plan.states[50].angle), 0.5);
  EXPECT_LT(std::abs(closed.angle - plan.states[50].angle), 0.02);
}

TEST(Feedback, KeepsTheBoundsAndLeavesInputsThatPushAgainstThem) {
  Scalar problem{.p = 2};
  Mppi controller{problem,
                  {.horizon = 4, .samples = 256, .variance = 100, .input_min = {-0.3}, .input_max = {0.3}}};
  Feedback feedback{controller};
  for (int i = 0; i < 20; ++i) controller.solve({100});
  const auto plan = controller.solve({100});
  ASSERT_TRUE(feedback.update(controller, plan));
  EXPECT_NEAR(plan.inputs[0][0], -0.3, 1e-6);
  EXPECT_EQ(feedback.gain(0)[0], 0);
  EXPECT_NEAR(feedback.input_at(0, {-500})[0], -0.3, 1e-6);

  const auto near = controller.solve({0});
  ASSERT_TRUE(feedback.update(controller, near));
  EXPECT_LT(feedback.gain(0)[0], 0);
  EXPECT_EQ(feedback.input_at(0, {-500})[0], controller.bounds().high[0]);
  EXPECT_EQ(feedback.input_at(0, {500})[0], controller.bounds().low[0]);
}

TEST(Feedback, HoldsWhateverStateAndTimeItIsGiven) {
  Mppi controller{Scalar{.a = 4}, {.horizon = 4, .samples = 64}};
  Feedback feedback{controller};
  EXPECT_EQ(feedback.input_at(0, {1})[0], 0) << "before the first update";
  const auto plan = controller.solve({1});
  ASSERT_TRUE(feedback.update(controller, plan));
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(feedback.input_at(0.1, {nan})[0], plan.inputs[1][0]);
  EXPECT_EQ(feedback.input_at(nan, {1})[0], plan.inputs[0][0]);
  EXPECT_EQ(feedback.input_at(inf, {1})[0], plan.inputs[0][0]);
  for (const double far : {1e30, 1.7e308}) EXPECT_TRUE(std::isfinite(feedback.input_at(0, {-far})[0])) << far;
  EXPECT_EQ(feedback.input_at(-3, plan.states[0])[0], plan.inputs[0][0]);
  EXPECT_EQ(feedback.input_at(1e300, plan.states[4])[0], plan.inputs[3][0]);
}

/// A cost that is not convex, has a kink, and no derivative where `broken`.
struct Odd {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  bool broken = false, bent = false;
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    return {s.x + T(0.1) * u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    return cos(s.x) + T(0.1) * u[0] * u[0] + (bent ? abs(T(0) * s.x) + abs(s.x - s.x * T(2)) : T(0)) +
           (broken ? log(abs(s.x) - abs(s.x)) : T(0));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return -s.x * s.x;
  }
};

TEST(Feedback, CostsThatAreNotConvexGiveFiniteGains) {
  Mppi controller{Odd{}, {.horizon = 8, .samples = 64}};
  Feedback feedback{controller};
  ASSERT_TRUE(feedback.update(controller, controller.solve({0.1})));
  for (int k = 0; k < 8; ++k) EXPECT_NEAR(feedback.gain(k)[0], 0, 1e-9) << "nothing holds the state";
  EXPECT_FALSE(feedback.has_kink());
  controller.problem().bent = true;
  ASSERT_TRUE(feedback.update(controller, controller.solve({0})));
  EXPECT_TRUE(feedback.has_kink());
}

TEST(Feedback, ADerivativeThatIsNotFiniteLeavesThePlan) {
  Mppi controller{Odd{}, {.horizon = 8, .samples = 64}};
  Feedback feedback{controller};
  const auto plan = controller.solve({0.1});
  controller.problem().broken = true;
  EXPECT_FALSE(feedback.update(controller, plan));
  EXPECT_EQ(feedback.input_at(0, {5})[0], plan.inputs[0][0]);
}

TEST(Feedback, AllocatesNothingAfterConstruction) {
  SvgMppi controller{problems::CartPole{}, {.horizon = 20, .input_min = {-10}, .input_max = {10}}};
  Feedback feedback{controller};
  const auto plan = controller.solve({0.1, 0, 3, 0});
  const long before = testing::allocations();
  ASSERT_GT(before, 0) << "nothing is counted";
  EXPECT_TRUE(feedback.update(controller, plan));
  double sum = 0;
  for (int i = 0; i < 100; ++i) sum += feedback.input_at(0.004 * i, plan.states[3])[0];
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_EQ(testing::allocations(), before);
}

TEST(FeedbackGains, TakesOnlySizesThatExist) {
  EXPECT_THROW(FeedbackGains(0, 1, 1, InputBounds(1)), std::invalid_argument);
  EXPECT_THROW(FeedbackGains(1, 0, 1, InputBounds(0)), std::invalid_argument);
  EXPECT_THROW(FeedbackGains(1, 1, 0, InputBounds(1)), std::invalid_argument);
  EXPECT_THROW(FeedbackGains(1, 2, 1, InputBounds(1)), std::invalid_argument);
}

TEST(FeedbackGains, RejectsBoundsInTheWrongOrder) {
  InputBounds bounds(2);
  bounds.low[1] = 2;
  bounds.high[1] = -1;
  EXPECT_EQ(message_of([&] { FeedbackGains(3, 2, 5, bounds); }),
            "feedback: bounds: the lower bound of input 1, 2, must be at most the upper bound, -1");
}

TEST(FeedbackGains, AnIndefiniteHessianCountsAsTheNearestSemidefiniteOne) {
  // Eigenvalues 3 and -1 along (1, 1) and (1, -1): what remains is 1.5 everywhere.
  FeedbackGains given(1, 1, 1, InputBounds(1)), nearest(1, 1, 1, InputBounds(1));
  for (FeedbackGains* gains : {&given, &nearest}) {
    const auto step = gains->step(0);
    step.state_jacobian[0] = 0.7;
    step.input_jacobian[0] = 0.4;
    const bool first = gains == &given;
    const double values[] = {first ? 1 : 1.5, first ? 2 : 1.5, first ? 2 : 1.5, first ? 1 : 1.5};
    std::copy(std::begin(values), std::end(values), step.hessian.begin());
    gains->terminal().hessian[0] = 1;
    ASSERT_TRUE(gains->solve(1));
  }
  EXPECT_NEAR(given.gain(0)[0], nearest.gain(0)[0], 1e-9);
  EXPECT_NEAR(given.gain(0)[0], -(1.5 + 0.4 * 0.7) / (1.5 + 0.16), 1e-8);
}

}  // namespace
}  // namespace slalom
