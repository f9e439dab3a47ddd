#include "slalom/core/derivatives/linearize.hpp"

#include <gtest/gtest.h>

#include <random>

#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"

namespace slalom {
namespace {

/// The step, the stage cost and the terminal cost of a problem as functions of an array of all scalars.
template <class P>
struct Functions {
  static constexpr int nx = detail::state_size<P>, nu = P::inputs, n = nx + nu;
  using Scalars = std::array<double, n>;
  P problem{};

  static std::pair<detail::StateOf<P, double>, Input<double, nu>> split(const Scalars& z) {
    return {detail::state_of<P, double>(z.data()), detail::inputs_of<P, double>(z.data() + nx)};
  }
  std::array<double, nx> step(const Scalars& z) const {
    const auto [x, u] = split(z);
    std::array<double, nx> next;
    detail::scalars_of<P, double>(
        detail::step<P, double>(problem, x, detail::look_up<P, double>(problem, x), u, 0), next.data());
    return next;
  }
  double stage(const Scalars& z) const {
    const auto [x, u] = split(z);
    return detail::total_of(
        detail::stage_cost<P, double>(problem, x, detail::look_up<P, double>(problem, x), u, 0));
  }
  double terminal(const Scalars& z) const {
    const auto x = split(z).first;
    return detail::total_of(
        detail::terminal_cost<P, double>(problem, x, detail::look_up<P, double>(problem, x)));
  }
};

template <class P>
class BuiltInProblems : public ::testing::Test {};
using AllProblems = ::testing::Types<problems::Pendulum, problems::CartPole, problems::DifferentialDrive,
                                     problems::Quadrotor, problems::Car, problems::Arm>;
TYPED_TEST_SUITE(BuiltInProblems, AllProblems, );

/// Equal but for rounding: where the processor has fused multiply-adds, a compiler forms other ones for a
/// dual number than for its value alone.
void expect_same(double a, double b) {
  EXPECT_NEAR(a, b, 1e-12 * (1 + std::abs(b)));
}

TYPED_TEST(BuiltInProblems, JacobiansAndGradientsAreThoseOfCentralDifferences) {
  using F = Functions<TypeParam>;
  const F f;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  int compared = 0;
  for (int trial = 0; trial < 40; ++trial) {
    typename F::Scalars z;
    for (double& v : z) v = uniform(random);
    const auto [x, u] = F::split(z);
    const auto l = linearize(f.problem, x, u);
    expect_same(l.cost, f.stage(z));
    EXPECT_FALSE(l.kink);
    double next[F::nx];
    detail::scalars_of<TypeParam, double>(l.next, next);
    for (int i = 0; i < F::nx; ++i) expect_same(next[i], f.step(z)[i]);
    const double h = 1e-6;
    for (int i = 0; i < F::n; ++i) {
      auto low = z, high = z;
      low[i] -= h;
      high[i] += h;
      const double up = f.stage(high) - f.stage(z), down = f.stage(z) - f.stage(low);
      if (std::abs(up - down) < 1e-8) {  // no jump and no kink within h
        const double gradient = i < F::nx ? l.state_gradient[i] : l.input_gradient[i - F::nx];
        EXPECT_NEAR(gradient, (up + down) / (2 * h), 1e-5 * (1 + std::abs(gradient))) << i;
        ++compared;
      }
      for (int row = 0; row < F::nx; ++row) {
        const double entry = i < F::nx ? l.state_jacobian[row][i] : l.input_jacobian[row][i - F::nx];
        EXPECT_NEAR(entry, (f.step(high)[row] - f.step(low)[row]) / (2 * h), 1e-7) << row << ' ' << i;
      }
    }
  }
  EXPECT_GT(compared, 38 * F::n);
}

TYPED_TEST(BuiltInProblems, HessiansAreTheDerivativesOfGradients) {
  using F = Functions<TypeParam>;
  const F f;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int trial = 0; trial < 10; ++trial) {
    typename F::Scalars z;
    for (double& v : z) v = uniform(random);
    const auto [x, u] = F::split(z);
    const auto cost = expand_stage_cost(f.problem, x, u);
    const auto end = expand_terminal_cost(f.problem, x);
    const auto l = linearize(f.problem, x, u);
    expect_same(cost.value, l.cost);
    EXPECT_NEAR(end.value, f.terminal(z), 1e-12 * std::abs(end.value));
    const auto gradient_of = [](const Linearization<TypeParam>& at) {
      typename F::Scalars gradient;
      std::copy_n(at.state_gradient, F::nx, gradient.begin());
      std::copy_n(at.input_gradient, F::nu, gradient.begin() + F::nx);
      return gradient;
    };
    const auto gradient = gradient_of(l);
    for (int i = 0; i < F::n; ++i) expect_same(cost.gradient[i], gradient[i]);
    const double h = 1e-6;
    for (int i = 0; i < F::n; ++i) {
      auto low = z, high = z;
      low[i] -= h;
      high[i] += h;
      const auto [x0, u0] = F::split(low);
      const auto [x1, u1] = F::split(high);
      const auto a = gradient_of(linearize(f.problem, x0, u0)), b = gradient_of(linearize(f.problem, x1, u1));
      const auto e0 = expand_terminal_cost(f.problem, x0), e1 = expand_terminal_cost(f.problem, x1);
      for (int j = 0; j < F::n; ++j) {
        const double second = (b[j] - a[j]) / (2 * h);
        EXPECT_NEAR(cost.hessian[i][j], second, 1e-5 * (1 + std::abs(second))) << i << ' ' << j;
        if (i >= F::nx || j >= F::nx) continue;
        const double at_end = (e1.gradient[j] - e0.gradient[j]) / (2 * h);
        EXPECT_NEAR(end.hessian[i][j], at_end, 1e-5 * (1 + std::abs(at_end))) << i << ' ' << j;
      }
    }
  }
}

/// Everything that a problem may have: a look-up, the step's index, named costs, a kink.
struct Whole {
  template <class T>
  struct State {
    T place[2];
  };
  static constexpr int inputs = 1;
  [[maybe_unused]] static constexpr std::array cost_names{"near", "far"};
  template <class T>
  T look_up(const State<T>& x) const {
    return x.place[0] * x.place[1];
  }
  template <class T>
  State<T> step(const State<T>& x, const T& seen, const Input<T, 1>& u, int k) const {
    return {{seen + T(k) * u[0], x.place[0]}};
  }
  template <class T>
  CostTerms<T, 2> stage_cost(const State<T>& x, const T& seen, const Input<T, 1>& u, int k) const {
    return {{abs(x.place[0]), T(k) * seen * u[0]}, x.place[1] > T(0)};
  }
  template <class T>
  Cost<T> terminal_cost(const State<T>& x, const T& seen) const {
    return {seen * seen, x.place[1] > T(0)};
  }
};

TEST(Linearize, TakesLookUpsStepIndicesAndNamedTermsAlong) {
  const auto l = linearize(Whole{}, {{2.0, 3.0}}, {{5.0}}, 7);
  EXPECT_EQ(l.next.place[0], 6 + 35);
  EXPECT_EQ(l.state_jacobian[0][0], 3);
  EXPECT_EQ(l.state_jacobian[0][1], 2);
  EXPECT_EQ(l.state_jacobian[1][0], 1);
  EXPECT_EQ(l.input_jacobian[0][0], 7);
  EXPECT_EQ(l.cost, 2 + 7 * 6 * 5);
  EXPECT_EQ(l.state_gradient[0], 1 + 7 * 3 * 5);
  EXPECT_EQ(l.input_gradient[0], 7 * 6);
  EXPECT_FALSE(l.kink);
  const auto cost = expand_stage_cost(Whole{}, {{2.0, 3.0}}, {{5.0}}, 7);
  EXPECT_EQ(cost.hessian[0][1], 7 * 5);
  EXPECT_EQ(cost.hessian[2][0], 7 * 3);
  const auto end = expand_terminal_cost(Whole{}, {{2.0, 3.0}});
  EXPECT_EQ(end.value, 36);
  EXPECT_EQ(end.hessian[0][0], 18);
  EXPECT_EQ(end.hessian[1][0], 24);
}

TEST(Linearize, TellsOfKinks) {
  EXPECT_TRUE(linearize(Whole{}, {{0.0, 3.0}}, {{5.0}}).kink);
  EXPECT_TRUE(expand_stage_cost(Whole{}, {{0.0, 3.0}}, {{5.0}}).kink);
  EXPECT_FALSE(expand_terminal_cost(Whole{}, {{0.0, 3.0}}).kink);
  const problems::DifferentialDrive drive;
  const auto at_goal = linearize(drive, {drive.goal_x, drive.goal_y, 0}, {{1.0, 0.0}});
  EXPECT_TRUE(at_goal.kink) << "the distance to the goal has no gradient there";
  for (const double g : at_goal.state_gradient) EXPECT_EQ(g, 0);
}

}  // namespace
}  // namespace slalom
