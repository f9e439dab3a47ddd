// Rollouts in several variants of the world: the risk of a sample is that of its costs in each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "slalom/core/risk/risk_evaluator.hpp"
#include "slalom/solvers/controllers.hpp"
#include "support/rollouts.hpp"

namespace slalom {
namespace {

/// A point flies through sideways wind whose gusts differ from step to step, along a cliff at y = 0.
struct Glider {
  template <class T>
  struct State {
    T x, y, speed;
  };
  static constexpr int inputs = 1;
  static constexpr int steps = 20;
  double dt = 0.1;             // s
  double input_min = -4;       // m/s^2
  double input_max = 2;        // m/s^2
  double input_rate_max = 30;  // m/s^3
  double gusts[steps] = {};    // m/s^2

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u, int k) const {
    return {s.x + T(dt), s.y + T(dt) * s.speed, s.speed + T(dt) * (u[0] + T(gusts[k]))};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    const mask_t<T> hit = s.y < T(0);
    return {square(s.y - T(0.3)) + T(0.01) * u[0] * u[0] + select(hit, T(10), T(0)), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return square(s.y - T(0.3));
  }
  void randomize(RandomStream& random) noexcept {
    for (double& gust : gusts) gust += 2 * random.normal();
  }
};
static_assert(RandomizableProblem<Glider>);

constexpr int samples = 300;

SequenceBatch some_inputs() {
  SequenceBatch batch(Glider::steps, 1, samples);
  std::mt19937 generator(5);
  std::normal_distribution<float> normal(0, 1.5f);
  for (int row = 0; row < batch.rows(); ++row)
    for (float& value : batch[row]) value = normal(generator);
  return batch;
}

/// The measure of costs in double, by its definition.
double risk_of(std::vector<double> costs, const RiskOptions& options) {
  std::sort(costs.rbegin(), costs.rend());
  const double count = costs.size();
  double sum = 0;
  switch (options.measure) {
    case RiskMeasure::mean:
      for (const double c : costs) sum += c / count;
      return sum;
    case RiskMeasure::worst:
      return costs.front();
    case RiskMeasure::cvar: {
      double left = options.tail * count;
      for (const double c : costs) {
        sum += c * std::clamp(left, 0.0, 1.0);
        left -= 1;
      }
      return sum / (options.tail * count);
    }
    case RiskMeasure::exponential:
      for (const double c : costs) sum += std::exp(options.aversion * c) / count;
      return std::log(sum) / options.aversion;
  }
  return 0;
}

class RiskMeasures : public ::testing::TestWithParam<RiskMeasure> {
 protected:
  RiskOptions options_{.variants = 7, .measure = GetParam(), .tail = 0.4, .aversion = 0.3, .seed = 11};
};

TEST_P(RiskMeasures, AgreeWithTheCostsOfEveryVariant) {
  RiskEvaluator evaluator(Glider{}, options_);
  const Glider::State<double> start{0, 0.4, 0};
  evaluator.set_state(start);
  const SequenceBatch batch = some_inputs();
  const auto [costs, collided] = testing::roll_out(evaluator, batch);
  int hits = 0, differ = 0;
  for (int sample = 0; sample < samples; ++sample) {
    auto u = testing::inputs_of<1>(batch, sample);
    // The rates of inputs are limited in rollouts.
    hold_input_rates(Glider{}, {0.0}, u.data(), Glider::steps);
    std::vector<double> of_variants;
    bool hit = false;
    for (int m = 0; m < options_.variants; ++m) {
      const Cost<double> cost =
          predict<Glider>(evaluator.variant(m), start, u.data(), Glider::steps, nullptr);
      of_variants.push_back(cost.value);
      hit = hit || cost.collided;
    }
    const double expected = risk_of(of_variants, options_);
    ASSERT_NEAR(costs[sample], expected, 1e-4 * (1 + expected)) << "sample " << sample;
    ASSERT_EQ(collided[sample], hit) << "sample " << sample;
    EXPECT_NEAR(evaluator.predict(start, u.data(), Glider::steps, nullptr).value, expected,
                1e-5 * (1 + expected));
    hits += hit;
    differ += of_variants[0] != of_variants[1];
  }
  EXPECT_GT(hits, 10);
  EXPECT_LT(hits, samples);
  EXPECT_EQ(differ, samples);
}

TEST_P(RiskMeasures, DoNotDependOnTheRangesOfSamples) {
  RiskEvaluator evaluator(Glider{}, options_);
  evaluator.set_state({0, 0.4, 0});
  const SequenceBatch batch = some_inputs();
  auto [whole, collided] = testing::roll_out(evaluator, batch);
  std::vector<float> parts(whole.size());
  for (int first = 0; first < samples; first += simd::padding)
    evaluator.evaluate(batch, first, std::min(simd::padding, samples - first), parts.data(), collided.data());
  whole.resize(samples);
  parts.resize(samples);
  EXPECT_EQ(whole, parts);
}

TEST_P(RiskMeasures, AreInfiniteForACostThatIsNotANumber) {
  VariantCosts costs{};
  for (int m = 0; m < options_.variants; ++m) costs.values[m][0] = costs.values[m][1] = 1;
  costs.values[3][0] = std::numeric_limits<float>::quiet_NaN();
  float risks[2];
  measure_risk(costs, 2, options_, risks);
  EXPECT_EQ(risks[0], std::numeric_limits<float>::infinity());
  EXPECT_NEAR(risks[1], 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Measures, RiskMeasures,
                         ::testing::Values(RiskMeasure::mean, RiskMeasure::worst, RiskMeasure::cvar,
                                           RiskMeasure::exponential),
                         [](const auto& tested) {
                           return enum_names(tested.param)[static_cast<int>(tested.param)];
                         });

TEST(RiskEvaluator, EqualsTheProblemForOneVariant) {
  RiskEvaluator risk(Glider{}, {});
  ProblemEvaluator plain(Glider{});
  const SequenceBatch batch = some_inputs();
  risk.set_state({0, 0.4, 0.1});
  plain.set_state({0, 0.4, 0.1});
  EXPECT_EQ(testing::roll_out(risk, batch).costs, testing::roll_out(plain, batch).costs);
}

/// The share of flights over the cliff that collide, and the mean height above it.
struct Flights {
  double collided = 0, height = 0;
};
Flights fly(const RiskOptions& risk, int flights) {
  Flights result;
  for (int flight = 0; flight < flights; ++flight) {
    SvgMppi controller{RiskEvaluator{Glider{}, risk},
                       {.horizon = Glider::steps,
                        .samples = 256,
                        .nearby_states = 0,
                        .temperature = 0.5,
                        .variance = 1,
                        .seed = 3}};
    RandomStream weather({100, static_cast<std::uint64_t>(flight)});
    Glider world;
    Glider::State<double> x{0, 0.3, 0};
    bool hit = false;
    for (int k = 0; k < 40; ++k) {
      world.gusts[0] = 2 * weather.normal();
      const auto plan = controller.solve(x, {.elapsed = world.dt});
      x = world.step(x, plan.inputs[0], 0);
      hit = hit || x.y < 0;
      result.height += x.y / (40 * flights);
    }
    result.collided += static_cast<double>(hit) / flights;
  }
  return result;
}

/// The purpose of the risk: the plan keeps the distance that gusts ask for.
TEST(RiskEvaluator, KeepsDistanceFromWhatAGustCouldReach) {
  const Flights nominal = fly({}, 40), averse = fly({.variants = 9, .measure = RiskMeasure::cvar}, 40);
  EXPECT_GT(averse.height, nominal.height + 0.05);
  EXPECT_LT(averse.collided, 0.5 * nominal.collided);
  EXPECT_GT(nominal.collided, 0.1);
}

}  // namespace
}  // namespace slalom
