#include <gtest/gtest.h>

#include <algorithm>

#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/problems.hpp"

/// The centre of the samples of `svg_mppi`: docs/algorithms/svg-mppi.md.
namespace slalom {
namespace {

constexpr int sample_steps = 8;
constexpr double stiffness = 0.5, wanted = 3, temperature = 0.4;

/// The cost 0.5 stiffness (v - wanted)^2, summed over the steps.
auto spring() {
  return testing::sum_over_steps([](double u, int) { return 0.5 * stiffness * (u - wanted) * (u - wanted); });
}

SvgMppiOptions options(SampleCentre centre) {
  SvgMppiOptions o = testing::closed_form(temperature);
  o.horizon = sample_steps;
  o.samples = 60000;
  o.temperature = temperature;
  o.variance_min = o.variance_max = 0.09;
  o.guides = {.count = 1,
              .iterations = 3,
              .step = 0.01,
              .variance = 0.09,
              .gradient_samples = 40,
              .gradient_variance = 0.09,
              .gradient_temperature = temperature,
              .restart = false,
              .sample_around = centre};
  return o;
}

TEST(SampleCentre, SamplesKeepTheirWeightsFarFromTheLastSolution) {
  // In the first solve the last solution is 0, and guides that take large sample_steps are ten deviations
  // away.
  SvgMppiOptions o = options(SampleCentre::nominal);
  o.samples = 1024;
  o.guides.iterations = 40;
  o.guides.step = 0.09;
  const double around_nominal = make_solver(o, 1)->solve(spring(), {}).effective_sample_size;
  o.guides.sample_around = SampleCentre::solution;
  const double around_solution = make_solver(o, 1)->solve(spring(), {}).effective_sample_size;
  EXPECT_GT(around_nominal, 500);
  EXPECT_LT(around_solution, 5);
}

TEST(SampleCentre, TheLastSolutionJoinsTheGuides) {
  // Guides that cannot move by themselves still follow the samples to the minimum.
  SvgMppiOptions o = options(SampleCentre::nominal);
  o.samples = 2000;
  o.guides.step = 1e-9;
  const auto solver = make_solver(o, 1);
  const auto evaluator = spring();
  for (int i = 0; i < 100; ++i) solver->solve(evaluator, {});
  for (const float n : solver->solve(evaluator, {}).nominal) EXPECT_NEAR(n, wanted, 0.25);
}

}  // namespace
}  // namespace slalom
