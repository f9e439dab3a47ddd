#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "slalom/problems/cart_pole.hpp"
#include "slalom/slalom.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/problems.hpp"
#include "support/allocations.hpp"
#include "support/thrown_words.hpp"

/// Exact gradients of costs, and guides of svg_mppi that follow them.
namespace slalom {
namespace {

using problems::CartPole;
using testing::DoubleIntegrator;

/// The gradient of an evaluator at a sequence.
struct Gradient {
  std::vector<float> values;
  GradientQuality quality;
};
Gradient gradient_at(const BatchEvaluator& evaluator, const std::vector<float>& sequence) {
  const CostGradient* const gradient = evaluator.gradient();
  Gradient result{std::vector<float>(sequence.size()), GradientQuality::not_finite};
  const int steps = static_cast<int>(sequence.size()) / evaluator.inputs();
  std::vector<double> workspace(gradient->workspace(steps));
  result.quality = gradient->differentiate(sequence, workspace, result.values);
  return result;
}

TEST(GradientEvaluator, AgreesWithDifferencesOfTheCost) {
  const CartPole problem;
  GradientEvaluator<CartPole> evaluator{problem};
  const CartPole::State<double> start{0.2, -0.5, 2.5, 1};
  evaluator.set_state(start);
  std::vector<float> sequence;
  for (int k = 0; k < 25; ++k) sequence.push_back(static_cast<float>(3 * std::sin(0.4 * k)));
  const Gradient gradient = gradient_at(evaluator, sequence);
  EXPECT_EQ(gradient.quality, GradientQuality::exact);
  std::vector<Input<double, 1>> u;
  for (const float value : sequence) u.push_back({{static_cast<double>(value)}});
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double before = u[k][0], h = 1e-5;
    u[k][0] = before + h;
    const double up = evaluator.predict(start, u.data(), 25, nullptr).value;
    u[k][0] = before - h;
    const double slope = (up - evaluator.predict(start, u.data(), 25, nullptr).value) / (2 * h);
    u[k][0] = before;
    EXPECT_NEAR(gradient.values[k], slope, 1e-5 * (1 + std::abs(slope))) << k;
  }
}

/// |x| with a jump beyond 1, and a cost that is not finite where `broken`.
struct Bent {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  double dt = 0.1;
  bool broken = false;
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    return {s.x + u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>&) const {
    return abs(s.x) + select(s.x > T(1), T(100), T(0)) + (broken ? log(abs(s.x) - abs(s.x)) : T(0));
  }
  template <class T>
  T terminal_cost(const State<T>&) const {
    return T(0);
  }
};

TEST(GradientEvaluator, TellsKinksAndDoesNotSeeJumps) {
  GradientEvaluator<Bent> evaluator{Bent{}};
  evaluator.set_state({0.5});
  const Gradient smooth = gradient_at(evaluator, {1, 0, 0});
  EXPECT_EQ(smooth.quality, GradientQuality::exact);
  EXPECT_EQ(smooth.values, (std::vector<float>{2, 1, 0})) << "of |x| alone, though 1.5 is beyond the jump";
  EXPECT_EQ(gradient_at(evaluator, {-0.5, 0, 0}).quality, GradientQuality::kink);
  evaluator.problem().broken = true;
  EXPECT_EQ(gradient_at(evaluator, {1, 0, 0}).quality, GradientQuality::not_finite);
}

struct Sluggish : DoubleIntegrator {
  double input_rate_max = 1;
};

TEST(GradientEvaluator, HasNoneWhereRatesAreLimited) {
  EXPECT_NE(GradientEvaluator<DoubleIntegrator>{DoubleIntegrator{}}.gradient(), nullptr);
  EXPECT_EQ(GradientEvaluator<Sluggish>{Sluggish{}}.gradient(), nullptr);
  EXPECT_EQ(ProblemEvaluator<DoubleIntegrator>{DoubleIntegrator{}}.gradient(), nullptr);
}

SvgMppiOptions exact_options() {
  return {.horizon = 20,
          .samples = 128,
          .input_min = -2,
          .input_max = 2,
          .guides = {.step = 0.05, .gradient_variance = 0.1, .gradient = GuideGradient::exact}};
}

/// The cost of a sequence of 20 inputs in double, from where the integrator starts in these tests.
double cost_of(const SequenceList& list, int sequence) {
  std::vector<Input<double, 1>> u;
  for (int k = 0; k < 20; ++k)
    u.push_back({{static_cast<double>(list.values[static_cast<std::size_t>(sequence * 20 + k)])}});
  return predict(DoubleIntegrator{}, {0.5, 0}, u.data(), 20, nullptr).value;
}

template <class P>
auto exact_controller(const P& problem, const SvgMppiOptions& options) {
  return Controller<GradientEvaluator<P>>(GradientEvaluator<P>(problem), options);
}

TEST(GuideGradient, ExactOnesLowerTheCostOfGuidesInEveryStep) {
  SvgMppiOptions options = exact_options();
  options.guides.restart = false;
  auto controller = exact_controller(DoubleIntegrator{}, options);
  const auto plan = controller.solve({0.5, 0});
  const int guides = options.guides.count, points = plan.stats.guide_path.sequences;
  ASSERT_EQ(points, guides * options.guides.iterations);
  for (int at = guides; at < points; ++at)
    EXPECT_LT(cost_of(plan.stats.guide_path, at), cost_of(plan.stats.guide_path, at - guides)) << at;
  EXPECT_EQ(plan.stats.gradient_kinks, 0);
}

TEST(GuideGradient, StepsThatAreTooLongAreHalved) {
  SvgMppiOptions options = exact_options();
  options.guides.restart = false;
  options.guides.step = 20;
  auto controller = exact_controller(DoubleIntegrator{}, options);
  const auto plan = controller.solve({0.5, 0});
  const int guides = options.guides.count;
  bool rose = false, fell = false;
  for (int g = 0; g < guides; ++g) {
    fell = fell || cost_of(plan.stats.guides, g) < cost_of(plan.stats.guide_path, g) - 1e-3;
    for (int at = g; at < plan.stats.guide_path.sequences; at += guides) {
      EXPECT_LE(cost_of(plan.stats.guides, g), cost_of(plan.stats.guide_path, at) + 1e-4);
      rose = rose || (at >= guides &&
                      cost_of(plan.stats.guide_path, at) > cost_of(plan.stats.guide_path, at - guides));
    }
  }
  EXPECT_TRUE(rose) << "no step was too long";
  EXPECT_TRUE(fell) << "no step was shortened enough";
}

/// Passes rollouts on. After `quick` of them it waits until the deadline has passed.
class Waiting final : public BatchEvaluator {
 public:
  Waiting(const BatchEvaluator& evaluator, int quick, const Deadline& deadline)
      : evaluator_(&evaluator), quick_(quick), deadline_(deadline) {}

  int inputs() const noexcept override { return evaluator_->inputs(); }
  double time_step() const noexcept override { return evaluator_->time_step(); }
  bool whole_batches() const noexcept override { return evaluator_->whole_batches(); }
  const CostGradient* gradient() const noexcept override { return evaluator_->gradient(); }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    evaluator_->evaluate(batch, first, count, costs, collided);
    if (++rollouts_ < quick_) return;
    while (!deadline_.passed()) {
    }
  }

 private:
  const BatchEvaluator* evaluator_;
  int quick_;
  mutable int rollouts_ = 0;
  Deadline deadline_;
};

TEST(GuidePath, HasTheCostsOfItsPoints) {
  for (const GuideGradient gradient : {GuideGradient::surrogate, GuideGradient::exact}) {
    SvgMppiOptions options = exact_options();
    options.guides.gradient = gradient;
    options.guides.step = 20;  // too long: guides return to where they were
    const std::vector<float> low(20, -2.0f), high(20, 2.0f), zero(20);
    GradientEvaluator<DoubleIntegrator> evaluator{DoubleIntegrator{}};
    evaluator.set_state({0.5, 0});
    detail::Guides guides(options, 1, low, high);
    guides.connect(evaluator);
    guides.restart({3, 0});
    guides.begin_move(zero.data(), zero.data(), 2);
    guides.move_share(0, evaluator, {4, 0}, {});
    // The second share, of two guides, is stopped in its fourth iteration.
    const Deadline soon(detail::Clock::now(), 0.3);
    guides.move_share(1, Waiting(evaluator, 7, soon), {4, 0}, soon);
    const int iterations = guides.end_move(evaluator);
    ASSERT_GT(iterations, 0);
    ASSERT_LT(iterations, options.guides.iterations);
    const SequenceList path = guides.path();
    ASSERT_EQ(path.sequences, iterations * options.guides.count);
    for (int at = 0; at < path.sequences; ++at) {
      const double cost = cost_of(path, at);
      EXPECT_NEAR(guides.path_costs()[static_cast<std::size_t>(at)], cost, 1e-4 * (1 + cost)) << at;
    }
  }
}

TEST(GuideGradient, GuidesStayWithinBoundsHoweverSteepTheCost) {
  SvgMppiOptions options = exact_options();
  options.guides.gradient_temperature = 1e-6;
  auto controller = exact_controller(DoubleIntegrator{}, options);
  const auto plan = controller.solve({500, 0});
  for (const float value : plan.stats.guide_path.values) EXPECT_LE(std::abs(value), 2.0f);
  const auto path = plan.stats.guide_path.values;
  double squares = 0;  // of the way of guide 1 in its second step, which goes on from the first
  for (std::size_t r = 0; r < 20; ++r) {
    const auto guides = static_cast<std::size_t>(options.guides.count);
    const double way = static_cast<double>(path[(2 * guides + 1) * 20 + r] - path[(guides + 1) * 20 + r]);
    squares += way * way;
  }
  const double longest = 0.05 / std::sqrt(0.1);  // step / Sigma_g of a standard deviation, for each entry
  EXPECT_LE(std::sqrt(squares / 20), 1.0001 * longest);
}

TEST(GuideGradient, KinksAndValuesThatAreNotFiniteAreCounted) {
  SvgMppiOptions options = exact_options();
  options.guides.variance = options.guides.restart_variance = 0;  // guides start at 0
  auto controller = exact_controller(Bent{}, options);
  EXPECT_GT(controller.solve({0}).stats.gradient_kinks, 0);
  controller.problem().broken = true;
  const auto plan = controller.solve({0.5});
  EXPECT_EQ(plan.stats.gradient_kinks, options.guides.count) << "one each, then they stay where they are";
  for (const float value : plan.stats.guides.values) EXPECT_TRUE(std::isfinite(value));
}

TEST(GuideGradient, SameBitsForAnyNumberOfThreadsAndNoAllocation) {
  SvgMppiOptions options = exact_options(), threaded = options;
  threaded.threads = 3;
  auto one = exact_controller(CartPole{}, options), three = exact_controller(CartPole{}, threaded);
  const long before = testing::allocations();
  ASSERT_GT(before, 0) << "nothing is counted";
  for (int i = 0; i < 5; ++i) {
    const auto a = one.solve({0, 0, 3, 0}, {.elapsed = 0.02}),
               b = three.solve({0, 0, 3, 0}, {.elapsed = 0.02});
    for (std::size_t k = 0; k < a.inputs.size(); ++k) EXPECT_EQ(a.inputs[k][0], b.inputs[k][0]);
  }
  EXPECT_EQ(testing::allocations(), before);
}

TEST(GuideGradient, WhatAProblemLacksIsSaidWhenTheControllerIsMade) {
  const std::string needs = "guide_gradient: exact needs a problem with derivatives";
  EXPECT_EQ(message_of([] { SvgMppi(DoubleIntegrator{}, exact_options()); }).substr(0, needs.size()), needs);
  EXPECT_EQ(message_of([] { exact_controller(Sluggish{}, exact_options()); }).substr(0, needs.size()), needs);
  EXPECT_EQ(message_of([] {
              SvgMppiOptions options = exact_options();
              options.guides.weight = GuideWeight::importance;
              make_solver(options, 1);
            }),
            "svg_mppi: guide_weight must be state_cost if guide_gradient is exact");
}

}  // namespace
}  // namespace slalom
