#include <gtest/gtest.h>

#include <limits>

#include "slalom/slalom.hpp"
#include "solvers/problems.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

using testing::DoubleIntegrator;

TEST(Controller, PlansTheStatesThatItsInputsLeadTo) {
  SvgMppi controller{DoubleIntegrator{}, {.horizon = 12, .samples = 256, .input_min = -2, .input_max = {2}}};
  const DoubleIntegrator::State<double> start{0.5, -0.1};
  const auto plan = controller.solve(start, {.elapsed = 0.1});
  ASSERT_EQ(plan.status, Status::ok);
  ASSERT_EQ(plan.inputs.size(), 12u);
  ASSERT_EQ(plan.states.size(), 13u);
  auto x = start;
  double cost = 0;
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(plan.states[k].position, x.position);
    EXPECT_EQ(plan.inputs[k][0], static_cast<double>(plan.stats.inputs[k]));
    cost += controller.problem().stage_cost(x, plan.inputs[k]);
    x = controller.problem().step(x, plan.inputs[k]);
  }
  EXPECT_EQ(plan.states[12].speed, x.speed);
  EXPECT_DOUBLE_EQ(plan.cost, cost + controller.problem().terminal_cost(x));
  EXPECT_FALSE(plan.collided);
}

TEST(Controller, RepeatsThePlanWhereTheStateIsNotFinite) {
  Mppi controller{DoubleIntegrator{}, {.horizon = 5, .input_min = {-2}, .input_max = {2}}};
  const auto first = controller.solve({0.5, 0});
  const std::vector<Input<double, 1>> inputs(first.inputs.begin(), first.inputs.end());
  const auto second = controller.solve({std::numeric_limits<double>::quiet_NaN(), 0});
  EXPECT_EQ(second.status, Status::non_finite_state);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(second.inputs[k][0], inputs[k][0]);
  EXPECT_EQ(second.states[0].position, 0.5);
}

/// An integrator whose steps have no stated duration.
struct Timeless {
  template <class T>
  using State = DoubleIntegrator::State<T>;
  static constexpr int inputs = 1;
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    return {x.position + T(0.1) * x.speed, x.speed + T(0.1) * u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>&) const {
    return square(x.position);
  }
};

TEST(Controller, RejectsTimesThatItCannotUse) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Mppi controller{DoubleIntegrator{}, {.horizon = 5}};
  for (const SolveRequest& request :
       {SolveRequest{.elapsed = -0.1}, SolveRequest{.elapsed = nan},
        SolveRequest{.elapsed = std::numeric_limits<double>::infinity()}, SolveRequest{.deadline = nan}})
    EXPECT_EQ(controller.solve({0.5, 0}, request).status, Status::invalid_time);
  EXPECT_NE(controller.solve({0.5, 0}, {.elapsed = 0.1, .deadline = -1}).status, Status::invalid_time);
  Mppi timeless{Timeless{}, {.horizon = 5}};
  EXPECT_EQ(timeless.solve({0.5, 0}, {.elapsed = 0.1}).status, Status::invalid_time);
  EXPECT_EQ(timeless.solve({0.5, 0}).status, Status::ok);
}

TEST(SolveBatch, GivesThePlansOfSingleSolvesOnAnyNumberOfThreads) {
  using Integrator = Mppi<DoubleIntegrator>;
  const Integrator one{DoubleIntegrator{},
                       {.horizon = 8, .samples = 128, .input_min = {-2}, .input_max = {2}}};
  std::vector<Integrator::State> states;
  for (int i = 0; i < 9; ++i) states.push_back({0.1 * i, 0});
  for (const int threads : {1, 3}) {
    std::vector<Integrator> batch(states.size(), one), single(states.size(), one);
    ThreadPool pool(threads);
    std::vector<double> found(states.size());
    for (int k = 0; k < 2; ++k) {  // the second solve starts from each controller's own last plan
      solve_batch(std::span(batch), states, {.elapsed = 0.1}, pool,
                  [&](int i, const auto& plan) { found[i] = plan.inputs[0][0]; });
      for (std::size_t i = 0; i < states.size(); ++i)
        EXPECT_EQ(found[i], single[i].solve(states[i], {.elapsed = 0.1}).inputs[0][0]) << i;
    }
  }
}

/// The problem of the copy is its own: the original's changes do not reach it, and both go on with the same
/// bits as controllers that were never copied.
template <class Make>
void expect_independent_copy(Make make) {
  const typename decltype(make())::State start{0.5, 0.1};
  auto original = make(), other = make();
  original.solve(start, {.elapsed = 0.1});
  other.solve(start, {.elapsed = 0.1});
  auto copy = original;
  original.problem().dt = 0.3;
  const auto unchanged = other.solve(start, {.elapsed = 0.1}), of_copy = copy.solve(start, {.elapsed = 0.1});
  const auto changed = original.solve(start, {.elapsed = 0.1});
  EXPECT_EQ(of_copy.cost, unchanged.cost);
  EXPECT_NE(of_copy.cost, changed.cost);
  EXPECT_NE(of_copy.stats.costs.data(), changed.stats.costs.data());
  for (std::size_t k = 0; k < of_copy.inputs.size(); ++k)
    EXPECT_EQ(of_copy.inputs[k][0], unchanged.inputs[k][0]) << k;
  original = other;  // and by assignment
  EXPECT_EQ(original.solve(start).cost, other.solve(start).cost);
}

TEST(Controller, ACopyHasAProblemOfItsOwn) {
  const SvgMppiOptions options{.horizon = 12, .samples = 256, .input_min = -2, .input_max = 2, .threads = 2};
  expect_independent_copy([&] { return SvgMppi{DoubleIntegrator{}, options}; });
  expect_independent_copy([&] { return Controller{DoubleIntegrator{}, SolverOptions(MppiOptions{})}; });
}

TEST(Controller, RejectsASolverForAnotherNumberOfInputs) {
  EXPECT_THROW(Controller(DoubleIntegrator{}, make_solver(MppiOptions{}, 2)), std::invalid_argument);
  EXPECT_THROW(Controller(DoubleIntegrator{}, nullptr), std::invalid_argument);
  EXPECT_THROW(Mppi(DoubleIntegrator{}, {.input_min = {-1, -2}}), std::invalid_argument);
}

/// Options of a method that lack the bounds of its inputs.
struct UnboundedOptions {
  static constexpr const char* method = "unbounded";
  int horizon = 5;
};

template <class Options, class Visit>
requires is_options_of<Options, UnboundedOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.horizon, {"horizon", "", "", 1});
}

std::unique_ptr<Solver> make_solver(const UnboundedOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool>) {
  return slalom::make_solver(MppiOptions{.horizon = options.horizon}, inputs);
}

TEST(Controller, NamesTheBoundThatOptionsLack) {
  EXPECT_EQ(message_of([] { Controller(DoubleIntegrator{}, SolverOptions(UnboundedOptions{})); }),
            "unbounded.input_min: missing; the options of a method must have this PerInput");
}

/// The double integrator by hand-written loops over a whole batch, as code for a GPU would be.
class BatchedIntegrator final : public BatchEvaluator {
 public:
  struct State {
    double position, speed;
  };
  static constexpr int input_count = 1;

  void set_state(const State& state) noexcept { start_ = state; }
  int inputs() const noexcept override { return input_count; }
  double time_step() const noexcept override { return 0.1; }
  bool whole_batches() const noexcept override { return true; }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    for (int k = first; k < first + count; ++k) {
      DoubleIntegrator::State<double> x{start_.position, start_.speed};
      double cost = 0;
      for (int t = 0; t < batch.steps(); ++t) {
        const Input<double, 1> u{{static_cast<double>(batch.at(t, 0, k))}};
        cost += problem_.stage_cost(x, u);
        x = problem_.step(x, u);
      }
      costs[k] = static_cast<float>(cost + problem_.terminal_cost(x));
      collided[k] = x.position > 100;
    }
  }

 private:
  DoubleIntegrator problem_;
  State start_{};
};

TEST(Controller, DrivesABatchedEvaluator) {
  static_assert(StateEvaluator<BatchedIntegrator>);
  const MppiOptions options{
      .horizon = 15, .samples = 256, .temperature = 0.1, .input_min = -2, .input_max = 2};
  Controller batched{BatchedIntegrator{}, options};
  DoubleIntegrator::State<double> x{1, 0};
  for (int k = 0; k < 80; ++k) {
    const auto plan = batched.solve({x.position, x.speed}, {.elapsed = 0.1});
    ASSERT_EQ(plan.status, Status::ok);
    ASSERT_EQ(plan.inputs.size(), 15u);
    EXPECT_TRUE(plan.states.empty());
    EXPECT_FALSE(plan.collided);
    EXPECT_EQ(plan.cost_terms[0].value, plan.cost);
    const double expected = predict(DoubleIntegrator{}, x, plan.inputs.data(), 15, nullptr).value;
    EXPECT_NEAR(plan.cost, expected, 1e-4 * expected + 1e-5) << k;
    x = DoubleIntegrator{}.step(x, plan.inputs[0]);
  }
  EXPECT_NEAR(x.position, 0, 0.1);
  EXPECT_EQ(batched.solve({std::nan(""), 0}).status, Status::non_finite_state);
}

}  // namespace
}  // namespace slalom
