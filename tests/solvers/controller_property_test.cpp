#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/passing_point.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"
#include "slalom/slalom.hpp"
#include "solvers/solver_contract.hpp"
#include "support/repetitions.hpp"

/// Random and adversarial calls of every method, option set and problem: every plan is valid.
namespace slalom {
namespace {

/// Random values, some of them at the limits of what a double is.
class Adversary {
 public:
  explicit Adversary(std::uint64_t seed) : random_(seed) {}
  int below(int count) { return static_cast<int>(random_() % static_cast<std::uint64_t>(count)); }
  bool once_in(int count) { return below(count) == 0; }
  double within(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  double any() {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    static constexpr double odd[] = {infinite, -infinite, -0.0, 4.9e-324, 1e-40,  1e15,
                                     -1e18,    3.4e38,    1e39, -1e200,   1.7e308};
    if (once_in(10)) return std::numeric_limits<double>::quiet_NaN();
    return once_in(3) ? odd[below(static_cast<int>(std::size(odd)))] : within(-3, 3);
  }

 private:
  std::mt19937_64 random_;
};

/// What the property is about: bounds that are narrow, equal, far from 0, huge or none.
std::pair<double, double> any_bounds(Adversary& adversary) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  static constexpr double values[] = {-infinite, -1e12, -1e6, -3, -1,  -0.1, 0,
                                      0.1,       0.3,   1,    7,  1e6, 1e12, infinite};
  const auto pick = [&] { return values[adversary.below(static_cast<int>(std::size(values)))]; };
  const double a = pick(), b = adversary.once_in(5) ? a : pick();
  const double low = std::min(a, b), high = std::max(a, b);
  return {low == infinite ? 0.5 : low, high == -infinite ? -0.5 : high};
}

struct Tally {
  long calls = 0, plans = 0, ok = 0, other = 0, corrections = 0;
};

struct RateLimited : testing::DoubleIntegrator {
  double input_min = -2, input_max = 2.5, input_rate_max = 4;
};

template <class P>
using StateValues = std::array<double, sizeof(typename Controller<P>::State) / sizeof(double)>;

template <class P>
void expect_valid(const Plan<P>& plan, const PerInput& low, const PerInput& high, const P& problem,
                  Tally& tally) {
  for (const auto& u : plan.inputs)
    for (int i = 0; i < P::inputs; ++i) {
      const double least = std::max(low[i], detail::least_input(problem, i));
      const double most = std::min(high[i], detail::largest_input(problem, i));
      ASSERT_TRUE(std::isfinite(u[i]) && u[i] >= least && u[i] <= most) << u[i];
    }
  for (std::size_t k = 1; k < plan.inputs.size(); ++k)
    for (int i = 0; i < P::inputs; ++i) {
      const double reach = detail::input_step(problem, i), before = plan.inputs[k - 1][i];
      const double change = std::abs(plan.inputs[k][i] - before);
      ASSERT_LE(change, (reach >= 0 ? reach : 0) + 1e-15 * std::abs(before)) << before;
    }
  ASSERT_TRUE(std::isfinite(plan.cost));
  for (const auto& x : plan.states) {
    StateValues<P> values;
    std::memcpy(values.data(), &x, sizeof values);
    for (const double value : values) ASSERT_TRUE(std::isfinite(value));
  }
  ++tally.plans;
  ++(plan.status == Status::ok ? tally.ok : tally.other);
  tally.corrections += plan.corrections;
}

/// One controller and a few dozen calls of its methods.
template <class P>
void try_controller(P problem, SolverOptions options, Adversary& adversary, Tally& tally) {
  const auto [low, high] = any_bounds(adversary);
  using testing::set, testing::set_if_any;
  set(options, "horizon", 1 + adversary.below(6));
  set(options, "samples", 1 + adversary.below(40));
  set_if_any(options, "gradient_samples", 1 + adversary.below(20));
  set_if_any(options, "guide_iterations", 1 + adversary.below(3));
  set(options, "variance", adversary.once_in(8) ? 1e12 : adversary.within(0, 4));
  set_if_any(options, "temperature", adversary.once_in(4) ? 1e-6 : adversary.within(0.01, 10));
  set(options, "input_min", low);
  set(options, "input_max", high);
  std::optional<Controller<P>> made;
  try {
    made.emplace(problem, options);
  } catch (const std::invalid_argument&) {  // bounds apart from the problem's
    ++tally.calls;
    return;
  }
  Controller<P>& controller = *made;
  for (int i = 0; i < 60; ++i) {
    tally.calls += 1;
    const int what = adversary.below(16);
    if (what == 0) {
      controller.reset(static_cast<std::uint64_t>(i));
    } else if (what == 1) {
      controller.prepare();
    } else if (what <= 3) {
      Input<double, P::inputs> told;
      for (int j = 0; j < P::inputs; ++j) told[j] = adversary.any();
      controller.set_previous_input(told);
    } else {
      StateValues<P> values;
      const bool hostile = adversary.once_in(3);
      for (double& value : values) value = hostile ? adversary.any() : adversary.within(-2, 2);
      typename Controller<P>::State x;
      std::memcpy(&x, values.data(), sizeof x);
      const bool finite =
          std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
      SolveRequest request{.elapsed = hostile ? adversary.any() : 0.05};
      if (adversary.once_in(10)) request.deadline = adversary.any();
      const auto plan = controller.solve(x, request);
      ASSERT_EQ(plan.status == Status::non_finite_state, !finite);
      expect_valid(plan, low, high, controller.problem(), tally);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(ControllerProperty, EveryPlanIsValidForAnyCall) {
  const long calls = testing::repetitions(200000);
  const auto sets = testing::option_sets();
  Tally tally;
  for (std::uint64_t seed = 0; tally.calls < calls; ++seed) {
    Adversary adversary(seed);
    const auto& set = sets[seed % sets.size()];
    SCOPED_TRACE("seed " + std::to_string(seed) + ", options " + set.name);
    switch (adversary.below(9)) {
      case 0:
        try_controller(testing::DoubleIntegrator{}, set.options, adversary, tally);
        break;
      case 1:
        try_controller(RateLimited{}, set.options, adversary, tally);
        break;
      case 2:
        try_controller(problems::Pendulum{}, set.options, adversary, tally);
        break;
      case 3:
        try_controller(problems::CartPole{}, set.options, adversary, tally);
        break;
      case 4:
        try_controller(problems::Quadrotor{}, set.options, adversary, tally);
        break;
      case 5:
        try_controller(problems::Arm{}, set.options, adversary, tally);
        break;
      case 6:
        try_controller(problems::Car{}, set.options, adversary, tally);
        break;
      case 7:
        try_controller(problems::DifferentialDrive{}, set.options, adversary, tally);
        break;
      default:
        try_controller(problems::PassingPoint{}, set.options, adversary, tally);
        break;
    }
    if (HasFatalFailure()) return;
  }
  std::printf("[ calls    ] %ld calls, %ld plans: %ld ok, %ld with another status; %ld corrections\n",
              tally.calls, tally.plans, tally.ok, tally.other, tally.corrections);
  EXPECT_GT(tally.ok, 0);
  EXPECT_GT(tally.other, 0);
}

}  // namespace
}  // namespace slalom
