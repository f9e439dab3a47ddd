#include <gtest/gtest.h>

#include <vector>

#include "slalom/slalom.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/problems.hpp"

/// The paths of the guides of svg_mppi.
namespace slalom {
namespace {

using testing::DoubleIntegrator;

/// Passes rollouts on. After `quick` of them it waits until the deadline has passed.
class Waiting final : public BatchEvaluator {
 public:
  Waiting(const BatchEvaluator& evaluator, int quick, const Deadline& deadline)
      : evaluator_(&evaluator), quick_(quick), deadline_(deadline) {}

  int inputs() const noexcept override { return evaluator_->inputs(); }
  double time_step() const noexcept override { return evaluator_->time_step(); }
  bool whole_batches() const noexcept override { return evaluator_->whole_batches(); }
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
  SvgMppiOptions options = testing::closed_form(1);
  options.horizon = 20;
  options.guides.step = 20;
  options.guides.gradient_variance = 0.1;
  const std::vector<float> low(20, -2.0f), high(20, 2.0f), zero(20);
  ProblemEvaluator<DoubleIntegrator> evaluator{DoubleIntegrator{}};
  evaluator.set_state({0.5, 0});
  detail::Guides guides(options, 1, low, high);
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
    std::vector<Input<double, 1>> u;
    for (int k = 0; k < 20; ++k)
      u.push_back({{static_cast<double>(path.values[static_cast<std::size_t>(at * 20 + k)])}});
    const double cost = predict(DoubleIntegrator{}, {0.5, 0}, u.data(), 20, nullptr).value;
    EXPECT_NEAR(guides.path_costs()[static_cast<std::size_t>(at)], cost, 1e-4 * (1 + cost)) << at;
  }
}

}  // namespace
}  // namespace slalom
