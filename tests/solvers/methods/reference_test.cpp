// The solver of SVG-MPPI against the paper's equations in plain loops, with the same random numbers.
#include <gtest/gtest.h>

#include "reference/svg_mppi.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/problems.hpp"

namespace slalom {
namespace {

constexpr int horizon = 8, inputs = 2, rows = horizon * inputs, guides = 3;
constexpr std::uint64_t seed = 5;

/// A point mass in the plane that comes to the origin past a hill; smooth, with a cost for its inputs.
double cost(const reference::Sequence& u) {
  double x = 1.5, y = 0.2, speed_x = -0.5, speed_y = 0, total = 0;
  for (int k = 0; k < horizon; ++k) {
    total += x * x + y * y + 0.05 * (u[2 * k] * u[2 * k] + u[2 * k + 1] * u[2 * k + 1]);
    total += 3 * std::exp(-4 * ((x - 0.7) * (x - 0.7) + y * y));
    x += 0.2 * speed_x;
    y += 0.2 * speed_y;
    speed_x += 0.2 * u[2 * k];
    speed_y += 0.2 * u[2 * k + 1];
  }
  return total + 5 * (x * x + y * y);
}

/// The normal values of a stage of a solve.
SequenceBatch noise(int solve, int stage, int samples) {
  SequenceBatch z(horizon, inputs, samples);
  fill_normal(z, 0, z.stride(),
              {seed, static_cast<std::uint64_t>(solve) << 16 | static_cast<std::uint64_t>(stage)});
  return z;
}

void expect_near(std::span<const float> actual, const reference::Sequence& expected, const char* what,
                 int solve) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t r = 0; r < expected.size(); ++r)
    EXPECT_NEAR(actual[r], expected[r], 1e-4) << what << " " << r << " of solve " << solve;
}

TEST(SvgMppi, IsThatOfThePaper) {
  reference::SvgMppi paper{.K = 300,
                           .L = 6,
                           .N = 40,
                           .lambda = 2,
                           .epsilon = 0.1,
                           .Sigma_g = 0.3,
                           .Sigma_0 = 0.8,
                           .Sigma_min = 0.005,
                           .Sigma_max = 0.9};
  SvgMppiOptions options;
  options.horizon = horizon;
  options.samples = paper.K;
  options.temperature = options.guides.gradient_temperature = paper.lambda;
  options.guides.count = guides;
  options.guides.iterations = paper.L;
  options.guides.step = paper.epsilon;
  options.guides.variance = paper.Sigma_0;
  options.guides.gradient_samples = paper.N;
  options.guides.gradient_variance = paper.Sigma_g;
  options.guides.weight = GuideWeight::importance;
  options.guides.restart = false;
  options.guides.sample_around = SampleCentre::solution;
  options.variance_min = paper.Sigma_min;
  options.variance_max = paper.Sigma_max;
  options.shift_warm_start = false;
  options.seed = seed;
  const auto solver = make_solver(options, inputs);
  const testing::FunctionEvaluator evaluator(inputs, [](const SequenceBatch& batch, int k) {
    reference::Sequence u;
    for (int r = 0; r < rows; ++r) u.push_back(static_cast<double>(batch.data(r)[k]));
    return std::pair(cost(u), false);
  });

  const SequenceBatch first = noise(0, 0, guides);
  for (int k = 0; k < guides; ++k) {
    paper.V_g.emplace_back();
    for (int r = 0; r < rows; ++r)
      paper.V_g.back().push_back(std::sqrt(paper.Sigma_0) * static_cast<double>(first.data(r)[k]));
  }
  paper.U_tilde = paper.U_hat = reference::Sequence(rows, 0);
  for (int solve = 0; solve < 4; ++solve) {
    const int block = padded(paper.N + 1);  // samples of a guide, and the guide itself
    const SequenceBatch samples = noise(solve, 1, paper.K);
    std::vector<SequenceBatch> around_guides;
    for (int l = 0; l < paper.L; ++l) around_guides.push_back(noise(solve, 2 + l, guides * block));
    paper.solve(cost, [&](int l, int k, int i, int r) {
      return static_cast<double>(k < 0 ? samples.data(r)[i]
                                       : around_guides[static_cast<std::size_t>(l)].data(r)[k * block + i]);
    });
    const SolveResult& result = solver->solve(evaluator, {});
    EXPECT_EQ(result.status, Status::ok);
    expect_near(result.nominal, paper.U_tilde, "nominal sequence", solve);
    expect_near(result.variances, paper.Sigma, "variance", solve);
    expect_near(result.inputs, paper.U_hat, "solution", solve);
  }
}

}  // namespace
}  // namespace slalom
