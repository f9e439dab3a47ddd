#include "solvers/methods/mppi_update.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace slalom::detail
