#include <gtest/gtest.h>

#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/problems.hpp"

/// The centre of the samples of `svg_mppi`: docs/algorithms/svg-mppi.md.
namespace slalom {
namespace {

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

}  // namespace
}  // namespace slalom
