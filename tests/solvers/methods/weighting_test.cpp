#include "solvers/methods/mppi_update.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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
    statistics = samples.draw_and_evaluate(evaluator, {7, 1}, {&mean, &deviation, &low, &high, 1000}, nullptr,
                                           pool, Deadline());
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
  BatchStatistics statistics;
};

TEST(Weighting, WeightsAreExponentials) {
  Drawn drawn([](double v) { return 10 + 2 * v * v; });
  Weighting weighting(1.7, 0);
  const WeightSums<double> sums = weighting.weigh(drawn.samples, drawn.statistics.minimum_total, drawn.pool);
  double total = 0;
  for (std::size_t k = 0; k < 1000; ++k) {
    const auto least = static_cast<double>(drawn.statistics.minimum_total);
    const double w = drawn.samples.weights()[k];
    EXPECT_NEAR(w, std::exp((least - static_cast<double>(drawn.samples.costs()[k])) / 1.7), 1e-5) << k;
    total += w;
  }
  EXPECT_NEAR(sums.weight, total, 1e-4 * total);
}

TEST(Weighting, InfiniteCostsHaveNoWeight) {
  Drawn drawn([](double v) { return v > 0 ? std::numeric_limits<double>::infinity() : v * v; });
  Weighting weighting(1, 0);
  const WeightSums<double> sums = weighting.weigh(drawn.samples, drawn.statistics.minimum_total, drawn.pool);
  EXPECT_TRUE(std::isfinite(sums.weight) && std::isfinite(sums.cost));
  for (std::size_t k = 0; k < 1000; ++k) {
    if (!std::isfinite(drawn.samples.costs()[k])) {
      EXPECT_EQ(drawn.samples.weights()[k], 0);
    }
  }
}

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

TEST(Weighting, CostsTimesAPowerOfTwoGiveTheSameWeights) {
  const auto weights = [](double factor) {
    Drawn drawn([factor](double v) { return factor * (std::abs(v - 1) + (v < 0 ? 100 : 0)); });
    Weighting weighting(1, 0.05);
    drawn.seek(weighting, 0.3f);
    drawn.seek(weighting, 0.2f);  // starts at the temperature that was found
    return std::vector<float>(drawn.samples.weights().begin(), drawn.samples.weights().end());
  };
  for (const int k : {-20, -3, 1, 20}) EXPECT_EQ(weights(std::ldexp(1, k)), weights(1)) << "2^" << k;
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
