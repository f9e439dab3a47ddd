#include "solvers/controller_calls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>

#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/passing_point.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"
#include "slalom/slalom.hpp"
#include "slalom/solvers/proposals.hpp"
#include "solvers/problems.hpp"
#include "solvers/set_option.hpp"
#include "support/promise.hpp"

namespace slalom::testing {
namespace {

/// Bounds that are narrow, equal, far from 0, huge or none.
std::pair<double, double> any_bounds(Adversary& adversary) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  static constexpr double values[] = {-infinite, -1e12, -1e6, -3, -1,  -0.1, 0,
                                      0.1,       0.3,   1,    7,  1e6, 1e12, infinite};
  const auto pick = [&] { return values[adversary.below(static_cast<int>(std::size(values)))]; };
  const double a = pick(), b = adversary.once_in(5) ? a : pick();
  const double low = std::min(a, b), high = std::max(a, b);
  return {low == infinite ? 0.5 : low, high == -infinite ? -0.5 : high};
}

/// The double integrator with a limit of its input's rate.
struct RateLimitedIntegrator : DoubleIntegrator {
  double input_min = -2, input_max = 2.5, input_rate_max = 4;
};

/// The same with another input gain in every variant of the world.
struct UncertainIntegrator : RateLimitedIntegrator {
  double gain = 1;
  void randomize(RandomStream& random) noexcept { gain = std::exp(0.5 * random.normal()); }
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    return RateLimitedIntegrator::step(x, Input<T, 1>{{T(gain) * u[0]}});
  }
};

template <class P>
using StateValues = std::array<double, sizeof(typename Controller<P>::State) / sizeof(double)>;

/// Throws Finding unless an input may follow another that far.
void check_rate(double reach, double before, double now) {
  require(std::abs(now - before) <= (reach >= 0 ? reach : 0) + 1e-15 * std::abs(before),
          "an input is within its rate");
}

/// Throws Finding unless a plan is finite, within the bounds and within the rates.
template <class P, class Problem>
void check_plan(const Plan<P>& plan, const PerInput& low, const PerInput& high, const Problem& problem) {
  constexpr int inputs = Problem::inputs;
  for (const auto& u : plan.inputs)
    for (int i = 0; i < inputs; ++i) {
      const double least = std::max(low[i], detail::min_input(problem, i));
      const double most = std::min(high[i], detail::largest_input(problem, i));
      require(std::isfinite(u[i]) && u[i] >= least && u[i] <= most,
              "an input is within its bounds: " + std::to_string(u[i]));
    }
  for (std::size_t k = 1; k < plan.inputs.size(); ++k)
    for (int i = 0; i < inputs; ++i)
      check_rate(detail::input_step(problem, i), plan.inputs[k - 1][i], plan.inputs[k][i]);
  require(std::isfinite(plan.cost), "the cost is finite");
  for (const auto& x : plan.states) {
    StateValues<P> values;
    std::memcpy(values.data(), &x, sizeof values);
    for (const double value : values) require(std::isfinite(value), "predicted states are finite");
  }
}

/// Sequences that compete with the samples of a solve.
template <class P>
void draw_proposals(Proposals<P>& proposals, Adversary& adversary) {
  std::array<typename Proposals<P>::Inputs, 4> inputs;
  proposals.clear();
  for (int i = adversary.below(3); i > 0; --i) {
    for (auto& u : inputs)
      for (double& value : u.value) value = adversary.any(-3, 3);
    proposals.add(std::span(inputs).first(adversary.below(5)));
  }
}

/// Solves from some state. `told` is what was applied before, or null.
template <class P>
void call_solve(Controller<P>& controller, const PerInput& low, const PerInput& high,
                const typename Controller<P>::Inputs* told, Proposals<P>* proposals, Adversary& adversary) {
  StateValues<P> values;
  const bool hostile = adversary.once_in(3);
  for (double& value : values) value = hostile ? adversary.any(-3, 3) : adversary.within(-2, 2);
  typename Controller<P>::State x;
  std::memcpy(&x, values.data(), sizeof x);
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  SolveRequest request{.elapsed = hostile ? adversary.any(-3, 3) : 0.05};
  if (adversary.once_in(10)) request.deadline = adversary.any(-3, 3);
  if (proposals) {
    draw_proposals(*proposals, adversary);
    request.proposals = *proposals;
  }
  const CallLimits limits;
  const auto plan = controller.solve(x, request);
  limits.check();
  require((plan.status == Status::non_finite_state) == !finite,
          "the status says whether the state was finite");
  check_plan(plan, low, high, controller.problem());
  const bool repeats = !finite || plan.status == Status::invalid_time;  // the last plan
  for (int i = 0; told && !repeats && i < controller.evaluator().inputs(); ++i) {
    const double before = controller.bounds().nearest(static_cast<std::size_t>(i), (*told)[i]);
    check_rate(detail::input_step(controller.problem(), i), before, plan.inputs[0][i]);
  }
}

/// One controller and a few dozen calls of its methods. Returns the number of plans.
template <class P>
int call_controller(P problem, SolverOptions options, Adversary& adversary) {
  std::vector<double> low, high;  // the same for all inputs, or others for each
  for (int i = 0, count = adversary.below(2) ? Controller<P>::Inputs::size() : 1; i < count; ++i) {
    const auto [least, most] = any_bounds(adversary);
    low.push_back(least);
    high.push_back(most);
  }
  set(options, "horizon", 1 + adversary.below(6));
  set(options, "samples", 1 + adversary.below(40));
  set_if_any(options, "gradient_samples", 1 + adversary.below(20));
  set_if_any(options, "guide_iterations", 1 + adversary.below(3));
  set(options, "variance", adversary.once_in(8) ? 1e12 : adversary.within(0, 4));
  set_if_any(options, "temperature", adversary.once_in(4) ? 1e-6 : adversary.within(0.01, 10));
  set(options, "input_min", low);
  set(options, "input_max", high);
  std::optional<Controller<P>> controller;
  std::optional<Proposals<P>> proposals;
  try {
    controller.emplace(problem, options);
    if (controller->solver().takes_proposals() && adversary.below(2)) proposals.emplace(*controller, 2);
  } catch (const std::invalid_argument&) {  // bounds apart from the problem's
    return 0;
  }
  typename Controller<P>::Inputs told{};  // what was applied before the next solve
  bool knows = false;
  int plans = 0;
  for (int i = 0; i < 60 && !adversary.is_done(); ++i) {
    const int what = adversary.below(16);
    if (what == 0) {
      controller->reset(static_cast<std::uint64_t>(i));
      knows = false;
    } else if (what == 1) {
      controller->prepare();
    } else if (what <= 3) {
      for (double& value : told.value) value = adversary.any(-3, 3);
      controller->set_previous_input(told);
      knows = std::all_of(std::begin(told.value), std::end(told.value),
                          [](double value) { return std::isfinite(value); });
    } else {
      call_solve(*controller, low, high, knows ? &told : nullptr, proposals ? &*proposals : nullptr,
                 adversary);
      knows = false;
      ++plans;
    }
  }
  return plans;
}

}  // namespace

int call_any_controller(const SolverOptions& options, Adversary& adversary) {
  const auto call = [&](auto problem) { return call_controller(problem, options, adversary); };
  switch (adversary.below(10)) {
    case 0:
      return call(DoubleIntegrator{});
    case 1:
      return call(RateLimitedIntegrator{});
    case 9: {
      const RiskMeasure measure = static_cast<RiskMeasure>(adversary.below(4));
      return call(RiskEvaluator{UncertainIntegrator{}, {.variants = 3, .measure = measure}});
    }
    case 2:
      return call(problems::Pendulum{});
    case 3:
      return call(problems::CartPole{});
    case 4:
      return call(problems::Quadrotor{});
    case 5:
      return call(problems::Arm{});
    case 6:
      return call(problems::Car{});
    case 7:
      return call(problems::DifferentialDrive{});
    default:
      return call(problems::PassingPoint{});
  }
}

}  // namespace slalom::testing
