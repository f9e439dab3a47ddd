// The equations of SVG-MPPI (Honda et al., ICRA 2024) against results that are known: integrals by
// quadrature, and quadratic costs, for which all distributions are Gaussian. docs/paper.md lists the
// equations.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/problems.hpp"

namespace slalom {
namespace {

using Function = std::function<double(double)>;

/// The integral of f over [-8, 8] by the midpoint rule.
double integral(const Function& f) {
  constexpr int slices = 16000;
  double sum = 0;
  for (int i = 0; i < slices; ++i) sum += f(-8 + 16 * (i + 0.5) / slices);
  return sum * 16 / slices;
}

double normal(double x, double mean, double variance) {
  return std::exp(-0.5 * (x - mean) * (x - mean) / variance) / std::sqrt(2 * 3.14159265358979324 * variance);
}

/// A cost of one input with two ways, at about -1 and 1, of which the second is better.
double two_ways(double v) {
  return 2 * (v * v - 1) * (v * v - 1) - 0.2 * v;
}

/// A solver of one step and one input, as the paper prints it, but for what a test changes.
SvgMppiOptions printed() {
  SvgMppiOptions options = testing::closed_form(0.7);
  options.horizon = 1;
  options.samples = 200000;
  options.guides.count = 1;
  options.guides.restart = false;
  options.guides.sample_around = SampleCentre::solution;
  options.guides.gradient_samples = 60000;
  options.guides.gradient_variance = 0.09;
  options.guides.step = 0.03;
  options.variance_min = 1e-9;
  options.variance_max = 100;
  options.shift_warm_start = false;
  options.seed = 3;
  return options;
}

auto evaluator_of(double (*cost)(double)) {
  return testing::FunctionEvaluator(1, [cost](const SequenceBatch& batch, int k) {
    return std::pair(cost(static_cast<double>(batch.data(0)[k])), false);
  });
}

/// Equations (7) and (8): the solution is the mean of q* ~ exp(-S / lambda) N(nominal, Sigma), wherever the
/// samples are drawn: around the last solution, as in the paper, or around the nominal sequence.
TEST(PaperEquations, WeightsOfEquation8GiveTheMeanOfTheOptimalDistribution) {
  SvgMppiOptions options = printed();
  options.adapt_covariance = false;
  options.variance = 0.4;
  options.guides.iterations = 4;
  const auto evaluator = evaluator_of(two_ways);
  for (const SampleCentre centre : {SampleCentre::solution, SampleCentre::nominal}) {
    options.guides.sample_around = centre;
    const auto solver = make_solver(options, 1);
    double last = 0, distance = 0;
    for (int solve = 0; solve < 4; ++solve) {
      const SolveResult& result = solver->solve(evaluator, {});
      const double nominal = result.nominal[0], lambda = options.temperature;
      const Function q = [&](double v) { return std::exp(-two_ways(v) / lambda) * normal(v, nominal, 0.4); };
      EXPECT_NEAR(result.inputs[0], integral([&](double v) { return v * q(v); }) / integral(q), 0.01)
          << solve;
      distance = std::max(distance, std::abs(nominal - last));
      last = static_cast<double>(result.inputs[0]);
    }
    EXPECT_GT(distance, 0.2) << "the control term of (8) must not vanish";
  }
}

/// Equation (10) as printed says KL(Q || Q*) = -E[log q*/q] <= -log E[q*/q]. By Jensen's inequality it is the
/// other way round; the right side is 0 for every Q, so no gradient of it leads anywhere.
TEST(PaperEquations, Equation10IsALowerBoundOfTheReverseDivergence) {
  const Function optimal = [](double v) { return 0.5 * normal(v, -1, 0.0625) + 0.5 * normal(v, 1, 0.0625); };
  for (const auto& [mean, variance] : {std::pair(0.0, 0.25), {0.0, 1.0}, {1.0, 0.0625}, {0.5, 0.09}}) {
    const auto expectation = [mean = mean, variance = variance](const Function& f) {
      return integral([&](double v) { return normal(v, mean, variance) * f(v); });
    };
    const Function ratio = [&, mean = mean, variance = variance](double v) {
      return optimal(v) / std::max(normal(v, mean, variance), 1e-300);
    };
    const double divergence = -expectation([&](double v) { return std::log(std::max(ratio(v), 1e-300)); });
    EXPECT_NEAR(-std::log(integral(optimal)), 0, 1e-6);
    EXPECT_GT(divergence, 0.1) << mean;
    // With exp(-S / lambda) in place of q*/q, as in (11), the bound is also a lower one.
    EXPECT_GT(-expectation([&](double v) { return std::log(optimal(v)); }), -std::log(expectation(optimal)));
  }
}

/// Equation (11) for S = 1/2 a (v - c)^2: log E[exp(-S / lambda)] has the gradient (c - theta) / (Sigma_g +
/// lambda / a).
TEST(PaperEquations, SurrogateGradientOfAQuadraticCost) {
  SvgMppiOptions options = printed();
  options.guides.variance = 1e-8;  // the guide begins at 0
  options.guides.iterations = 20;
  const auto evaluator = evaluator_of([](double v) { return 0.5 * 3 * (v - 1.5) * (v - 1.5); });
  const auto solver = make_solver(options, 1);
  const SolveResult& result = solver->solve(evaluator, {});
  const double factor = 1 - 0.03 / (0.09 + 0.7 / 3);
  EXPECT_NEAR(result.nominal[0], 1.5 * (1 - std::pow(factor, 20)), 0.01);
}

/// The control term of (8) in (11), for S = 1/2 a (v - c)^2: guides go to c - lambda / a (u - n) / Sigma,
/// with the last solution u and nominal sequence n. A smaller Sigma holds them more where they are.
TEST(PaperEquations, ControlTermHoldsGuidesBack) {
  SvgMppiOptions options = printed();
  options.guides.weight = GuideWeight::importance;
  options.guides.variance = options.variance = 0.2;
  options.guides.iterations = 8;
  options.adapt_covariance = false;
  const auto evaluator = evaluator_of([](double v) { return 0.5 * 3 * (v - 1.5) * (v - 1.5); });
  const auto solver = make_solver(options, 1);
  const SolveResult& result = solver->solve(evaluator, {});
  const double n = result.nominal[0], u = result.inputs[0];
  const double share = 1 - std::pow(1 - 0.03 / (0.09 + 0.7 / 3), 8);
  const double moved = share * (1.5 - 0.7 / 3 * (u - n) / 0.2 - n);
  EXPECT_NEAR(solver->solve(evaluator, {}).nominal[0] - n, moved, 0.01);
  EXPECT_LT(std::abs(moved), 0.6 * std::abs(share * (1.5 - n))) << "without the term";
}

/// Equation (11) for any cost: a step goes the fraction epsilon / Sigma_g of the way to the mean of exp(-S /
/// lambda) N(theta, Sigma_g). This solves the forward divergence for that prior, not the reverse one.
TEST(PaperEquations, StepOfAGuideIsADampedForwardStep) {
  SvgMppiOptions options = printed();
  options.guides.variance = 1e-8;
  options.guides.iterations = 3;
  const auto evaluator = evaluator_of(two_ways);
  const auto solver = make_solver(options, 1);
  const SolveResult& result = solver->solve(evaluator, {});
  double theta = 0;
  for (int l = 0; l < 3; ++l) {
    const Function p = [&](double v) { return std::exp(-two_ways(v) / 0.7) * normal(v, theta, 0.09); };
    theta += 0.03 / 0.09 * (integral([&](double v) { return v * p(v); }) / integral(p) - theta);
  }
  EXPECT_NEAR(result.nominal[0], theta, 0.005);
}

/// Equation (12): the nominal sequence is the guide with the least cost.
TEST(PaperEquations, NominalSequenceIsTheBestGuide) {
  SvgMppiOptions options = printed();
  options.guides.count = 8;
  options.guides.gradient_samples = 50;
  options.seed = 2;
  const auto solver = make_solver(options, 1);
  const SolveResult& result = solver->solve(evaluator_of(two_ways), {});
  ASSERT_EQ(result.guides.sequences, 8);
  double least = 1e9, first = 0;
  for (int k = 0; k < 8; ++k) {
    const double guide = result.guides.values[k];
    if (two_ways(guide) < two_ways(least)) least = guide;
    first = k == 0 ? guide : first;
  }
  EXPECT_FLOAT_EQ(result.nominal[0], static_cast<float>(least));
  EXPECT_NE(static_cast<float>(first), result.nominal[0])
      << "a seed for which the first guide is not the best";
}

/// L K_g N rollouts of T steps move the guides: an eighth of the K of the batch after them, in L calls of
/// which each needs the last.
TEST(PaperEquations, GuidesTakeAnEighthOfTheRollouts) {
  SvgMppiOptions options = printed();
  options.samples = 8000;
  options.guides.gradient_samples = 100;
  int rollouts = 0;
  const testing::FunctionEvaluator evaluator(1, [&](const SequenceBatch& batch, int k) {
    ++rollouts;
    return std::pair(two_ways(static_cast<double>(batch.data(0)[k])), false);
  });
  make_solver(options, 1)->solve(evaluator, {});
  EXPECT_NEAR(rollouts - 8000, 10 * 1 * 100, 130) << "with the guide itself, in whole packs";
}

/// Equation (13) for S = 1/2 a (v - c)^2: exp(-S / lambda) has the variance lambda / a, and q* of equation
/// (5) has 1 / (a / lambda + 1 / Sigma). As printed, the square root of that is the "variance".
TEST(PaperEquations, FitRecoversTheVarianceOfAGaussian) {
  const auto fitted = [](double a, double sigma, auto change) {
    const testing::FunctionEvaluator evaluator(1, [a](const SequenceBatch& batch, int k) {
      const double distance = static_cast<double>(batch.data(0)[k]) - 1.5;
      return std::pair(0.5 * a * distance * distance, false);
    });
    SvgMppiOptions options = printed();
    options.guides.variance = sigma;
    options.guides.gradient_samples = 500;
    options.guides.iterations = 12;
    change(options.published, options.guides);
    return static_cast<double>(make_solver(options, 1)->solve(evaluator, {}).variances[0]);
  };
  const auto as_printed = [](auto& fit, auto&) { fit.fit_target = FitTarget::optimal_density; };
  const auto state_cost = [](auto& fit, auto&) {
    fit.fit_target = FitTarget::state_cost;
    fit.fit_temperature = 0.7;
  };
  const double variance = 0.7 / 3, optimal = 1 / (1 / variance + 1 / 0.5);
  EXPECT_NEAR(fitted(3, 0.5, state_cost), variance, 0.01 * variance);
  EXPECT_NEAR(fitted(3, 0.5, as_printed), optimal, 0.01 * optimal);
  EXPECT_NEAR(fitted(3, 0.5, [](auto& fit, auto&) { fit.fit_standard_deviation = true; }), std::sqrt(optimal),
              0.005);
  EXPECT_EQ(fitted(3, 0.5, [](auto&, auto& guides) { guides.iterations = 2; }), 100) << "two points";
  EXPECT_EQ(fitted(3, 0.5, [](auto&, auto& guides) { guides.step = 1e-12; }), 100)
      << "a guide that does not move";
  EXPECT_GT(fitted(0.3, 0.5, as_printed), 1.5 * optimal) << "where q* hardly changes, the variance is large";
  // With the fit as the next Sigma, as (5) and (13) ask for, it shrinks in every solve: no Sigma > 0 agrees.
  double sigma = 0.5;
  for (int n = 1; n < 4; ++n) {
    sigma = fitted(3, sigma, as_printed);
    EXPECT_NEAR(1 / sigma, 1 / 0.5 + n / variance, 0.1) << n;
  }
}

}  // namespace
}  // namespace slalom
