#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slalom/slalom.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/methods/gaussian_fit.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/problems.hpp"

/// The paths of the guides of svg_mppi, and the Gaussians that are fitted to them.
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
    for (int k = 0; k < 20; ++k) u.push_back({{path.values[at * 20 + k]}});
    const double cost = predict(DoubleIntegrator{}, {0.5, 0}, u.data(), 20, nullptr).value;
    EXPECT_NEAR(guides.path_costs()[at], cost, 1e-4 * (1 + cost)) << at;
  }
}

/// The variance fitted to points of a Gaussian with the mean 0.3 more than the first abscissa; infinite if it
/// is undetermined.
double fitted(double variance, double first, double spacing, double error = 0) {
  std::vector<double> x, density;
  for (int k = 0; k < 10; ++k) {
    x.push_back(first + spacing * k);
    const double d = spacing * k - 0.3;
    density.push_back(std::exp(-0.5 * d * d / variance));
  }
  std::vector<double> square(x.size()), logarithm(x.size());
  const int count = static_cast<int>(x.size());
  detail::fit_weights(density.data(), count, square.data(), logarithm.data());
  return detail::fitted_variance(
      detail::fit_gaussian(x.data(), square.data(), logarithm.data(), count, error), false);
}

TEST(GaussianFit, FindsTheVarianceWhereverTheMeanIs) {
  for (const double first : {0.0, -3.0, 100.0, 1000.0}) {
    EXPECT_NEAR(fitted(0.04, first, 0.1), 0.04, 1e-9) << first;
    EXPECT_NEAR(fitted(0.5, first, 0.1), 0.5, 1e-8) << first;
  }
}

TEST(GaussianFit, IsUndeterminedWhereRoundingDecides) {
  EXPECT_TRUE(std::isinf(fitted(0.04, 1, 0)));
  // Abscissas that float32 does not tell apart, and densities that differ less than their error.
  EXPECT_TRUE(std::isinf(fitted(0.04, 1, 1e-8)));
  EXPECT_TRUE(std::isinf(fitted(0.04, 1, 1e-3, 1e-2)));
  EXPECT_FALSE(std::isinf(fitted(0.04, 1, 0.1, 1e-2)));
}

}  // namespace
}  // namespace slalom
