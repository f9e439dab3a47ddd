/// The centre of the samples of `svg_mppi`: docs/algorithms/svg-mppi.md.
/// The paths of the guides of svg_mppi, and the Gaussians that are fitted to them.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slalom/slalom.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/methods/gaussian_fit.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/methods/mppi_update.hpp"
#include "solvers/problems.hpp"

namespace slalom::detail {
namespace {

using slalom::testing::FunctionEvaluator;

/// A thousand samples of one step whose cost is a function of their input.
template <class Cost>
struct Drawn {
  explicit Drawn(Cost cost) : pool(1), samples(1, 1, 1000) {
    const float mean = 0, deviation = 1, low = -100, high = 100;
    const FunctionEvaluator evaluator(1, [cost](const SequenceBatch& batch, int k) {
      return std::pair<double, bool>(cost(static_cast<double>(batch.at(0, 0, k))), false);
    });
    samples.draw_and_evaluate(evaluator, {7, 1}, {&mean, &deviation, &low, &high, 1000}, nullptr, pool, {});
  }
  /// Weighs the samples with an adapted temperature. `linear` is the coefficient of the control term.
  WeightSums<double> seek(Weighting& weighting, float linear = 0) {
    samples.keep_terms(&linear, pool);
    return weighting.seek(samples, pool);
  }
  double effective() const {
    double sum = 0, squared = 0;
    for (const float w : samples.weights()) {
      sum += static_cast<double>(w);
      squared += static_cast<double>(w) * static_cast<double>(w);
    }
    return sum * sum / squared;
  }

  ThreadPool pool;
  SampleSet samples;
};

TEST(Weighting, FindsTheTemperatureForAnEffectiveSampleSize) {
  for (const double scale : {1e-3, 1.0, 1e5}) {
    for (const double share : {0.01, 0.1, 0.5}) {
      Drawn drawn([scale](double v) { return scale * (v - 1) * (v - 1); });
      Weighting weighting(1, share);
      drawn.seek(weighting);
      EXPECT_NEAR(drawn.effective(), share * 1000, 0.011 * share * 1000)
          << "costs of " << scale << ", lambda " << weighting.temperature();
    }
  }
}

TEST(Weighting, ControlTermIsInUnitsOfTheTemperature) {
  // J = S + lambda g: weights exp(-S / lambda - g), whatever lambda was found.
  Drawn drawn([](double v) { return 50 * v * v; });
  Weighting weighting(1, 0.3);
  drawn.seek(weighting, 0.8f);
  const auto& w = drawn.samples.weights();
  const auto exponent = [&](std::size_t k) {
    return static_cast<double>(drawn.samples.costs()[k]) / weighting.temperature() +
           0.8 * static_cast<double>(drawn.samples.values().at(0, 0, static_cast<int>(k)));
  };
  for (std::size_t k = 1; k < 1000; ++k) {
    EXPECT_NEAR(w[k], static_cast<double>(w[0]) * std::exp(exponent(0) - exponent(k)), 2e-5) << k;
  }
}

TEST(Weighting, KeepsTheTemperatureWhereNoneFits) {
  Drawn equal([](double) { return 5.0; });
  Weighting weighting(2.5, 0.1);
  const WeightSums<double> sums = equal.seek(weighting);
  EXPECT_DOUBLE_EQ(weighting.temperature(), 2.5);
  EXPECT_NEAR(sums.weight, 1000, 1e-3);
}

/// The cost 0.25 (v - 3)^2, summed over the steps.
auto spring() {
  return testing::sum_over_steps([](double u, int) { return 0.25 * (u - 3) * (u - 3); });
}

SvgMppiOptions with_step(double step) {
  SvgMppiOptions o = testing::closed_form(0.4);
  o.horizon = 8;
  o.samples = 2000;
  o.variance_min = o.variance_max = o.guides.variance = o.guides.gradient_variance = 0.09;
  o.guides.count = 1;
  o.guides.iterations = 40;
  o.guides.gradient_samples = 40;
  o.guides.step = step;
  o.guides.restart = false;
  return o;
}

TEST(SampleCentre, SamplesKeepTheirWeightsFarFromTheLastSolution) {
  // In the first solve the last solution is 0, and guides that take large steps are ten deviations away.
  SvgMppiOptions o = with_step(0.09);
  EXPECT_GT(make_solver(o, 1)->solve(spring(), {}).effective_sample_size, 1000);
  o.guides.sample_around = SampleCentre::solution;
  EXPECT_LT(make_solver(o, 1)->solve(spring(), {}).effective_sample_size, 5);
}

TEST(SampleCentre, TheLastSolutionJoinsTheGuides) {
  // Guides that cannot move by themselves still follow the samples to the minimum.
  const auto solver = make_solver(with_step(1e-9), 1);
  const auto evaluator = spring();
  for (int i = 0; i < 100; ++i) solver->solve(evaluator, {});
  for (const float n : solver->solve(evaluator, {}).nominal) EXPECT_NEAR(n, 3, 0.25);
}

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

}  // namespace slalom::detail
