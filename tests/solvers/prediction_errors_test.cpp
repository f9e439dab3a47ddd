#include "slalom/solvers/prediction_errors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/solver_base.hpp"
#include "solvers/problems.hpp"
#include "suite/task.hpp"

namespace slalom {
namespace {

using testing::DoubleIntegrator;
using Vector = std::array<double, 2>;

/// The states that errors make of `state`.
std::vector<Vector> moved(const PredictionErrors& errors, Vector state) {
  std::vector<Vector> all(static_cast<std::size_t>(errors.count()));
  for (std::size_t i = 0; i < all.size(); ++i) errors.move(state, static_cast<int>(i), all[i]);
  return all;
}

TEST(PredictionErrors, MoveAStateEitherWay) {
  PredictionErrors errors(2);
  errors.add(Vector{1.5, 0}, Vector{1, 0});
  errors.add(Vector{2, 0.25}, Vector{2, 0});
  errors.add(Vector{2, 1}, Vector{1.5, 0.75});
  const std::vector<Vector> expected = {{10.5, 20},  {9.5, 20},     {10, 20.25},
                                        {10, 19.75}, {10.5, 20.25}, {9.5, 19.75}};
  EXPECT_EQ(moved(errors, {10, 20}), expected);
  for (int i = 0; i < 100; ++i) errors.add(Vector{1, 1}, Vector{0.5, 0.5});
  EXPECT_EQ(errors.count(), 2 * PredictionErrors::kept);
  errors.clear();
  EXPECT_EQ(errors.count(), 0);
}

TEST(PredictionErrors, AJumpAndRoundingAreNone) {
  PredictionErrors errors(2);
  errors.add(Vector{-3.1, 1}, Vector{3.18, 1});  // an angle that starts anew
  EXPECT_EQ(errors.count(), 0);
  errors.add(Vector{1000.00001, 1}, Vector{1000, 1});
  EXPECT_EQ(errors.count(), 0);
  errors.add(Vector{1, 1.25}, Vector{1, 1});
  errors.add(Vector{1, 1.25}, Vector{1, 1});
  EXPECT_EQ(moved(errors, {5, 5})[0], (Vector{5, 5})) << "the jump counts no more than the second largest, 0";
}

/// A solver that keeps the states near the present one.
class Witness final : public SolverBase {
 public:
  Witness() : SolverBase(SvgMppiOptions{.horizon = 5}, 1, nullptr), plan_(5, 1.0f) { result_.inputs = plan_; }
  const char* name() const noexcept override { return "witness"; }
  std::unique_ptr<Solver> clone() const override { return std::make_unique<Witness>(); }
  void reset(std::uint64_t) noexcept override {}
  const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept override {
    const auto& own = static_cast<const ProblemEvaluator<DoubleIntegrator>&>(evaluator);
    starts.clear();
    for (int i = 0; i < request.nearby->count(); ++i) {
      request.nearby->start_at(i);
      starts.push_back({own.start()[0], own.start()[1]});
    }
    request.nearby->start_at(-1);
    present = {own.start()[0], own.start()[1]};
    return result_;
  }
  std::vector<std::array<float, 2>> starts;
  std::array<float, 2> present;

 private:
  std::vector<float> plan_;
};

TEST(Controller, TellsItsSolverWherePredictionsFailed) {
  auto solver = std::make_unique<Witness>();
  Witness& witness = *solver;
  Controller controller(DoubleIntegrator{}, std::move(solver));
  controller.solve({0, 0});
  controller.solve({0, 0.1}, {.elapsed = 0.1});       // as the plan predicts
  controller.solve({0.02, 0.25}, {.elapsed = 0.15});  // after a step and a half of 0.1 s
  EXPECT_TRUE(witness.starts.empty());
  controller.solve({0.045, 0.475}, {.elapsed = 0.1});  // 0.125 too fast
  EXPECT_TRUE(witness.starts.empty()) << "a single error may be a jump";
  controller.solve({0.0925, 0.7}, {.elapsed = 0.1});
  ASSERT_EQ(witness.starts.size(), 8u);
  EXPECT_FLOAT_EQ(witness.starts[6][1], 0.825f);
  EXPECT_FLOAT_EQ(witness.starts[7][1], 0.575f);
  EXPECT_FLOAT_EQ(witness.present[1], 0.7f);
  controller.solve({5, 5});  // no time has passed, so nothing was predicted
  EXPECT_FLOAT_EQ(witness.starts[6][1], 5.125f);
  for (int i = 0; i < 10; ++i) controller.solve({5, 5}, {.elapsed = 0.1});
  EXPECT_TRUE(witness.starts.empty()) << "what never changes is a frame that moves with the robot";
  controller.reset(1);
  controller.solve({7, 7}, {.elapsed = 0.1});
  EXPECT_TRUE(witness.starts.empty());
}

TEST(GuidedMppi, PlansThatHoldFromNearbyStatesPassObstaclesWhereTheModelIsWrong) {
  int solved[2] = {0, 0};
  for (const suite::Task& task : suite::all_tasks()) {
    if (task.name != "two_ways_round" && task.name != "parked_cars" && task.name != "moving_goal") continue;
    for (const int states : {0, 16}) {
      SolverOptions options = suite::default_options("svg_mppi", task);
      options.get_if<SvgMppiOptions>()->nearby_states = states;
      solved[states > 0] +=
          task.run({.options = options, .first = 300, .count = 20, .disturbed = true}).solved;
    }
  }
  EXPECT_GE(solved[1], 55) << "of 60";
  EXPECT_LE(solved[0], 50) << "the errors decide nothing";
}

}  // namespace
}  // namespace slalom
