// The solver of SVG-MPPI against the paper's equations in plain loops, with the same random numbers, and both
// against recorded figures, with which examples/python/svg_mppi.py is compared, too.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "reference/svg_mppi.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/closed_form.hpp"
#include "solvers/problems.hpp"

namespace slalom {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t seed = 5;

/// A point mass in the plane that comes to the origin past a hill; smooth, with a cost for its two inputs.
double cost(const reference::Sequence& u) {
  double x = 1.5, y = 0.2, speed_x = -0.5, speed_y = 0, total = 0;
  for (std::size_t k = 0; k < u.size(); k += 2) {
    total += x * x + y * y + 0.05 * (u[k] * u[k] + u[k + 1] * u[k + 1]);
    total += 3 * std::exp(-4 * ((x - 0.7) * (x - 0.7) + y * y));
    x += 0.2 * speed_x;
    y += 0.2 * speed_y;
    speed_x += 0.2 * u[k];
    speed_y += 0.2 * u[k + 1];
  }
  return total + 5 * (x * x + y * y);
}

void expect_near(std::span<const float> actual, const reference::Sequence& expected, const char* what,
                 int solve) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t r = 0; r < expected.size(); ++r)
    EXPECT_NEAR(actual[r], expected[r], 1e-4) << what << " " << r << " of solve " << solve;
}

/// A number as it is recorded.
double rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", value);
  return std::strtod(text, nullptr);
}

Json recorded(const reference::Sequence& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(rounded(value));
  return json;
}

/// Solves with both, and compares them. Returns the random numbers and the results of the plain loops.
Json solve_with_both(reference::SvgMppi paper, int horizon, int guides, int solves) {
  const int inputs = 2, rows = horizon * inputs;
  SvgMppiOptions options = testing::closed_form(paper.lambda);
  options.horizon = horizon;
  options.samples = paper.K;
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
  const testing::FunctionEvaluator evaluator(inputs, [rows](const SequenceBatch& batch, int k) {
    reference::Sequence u;
    for (int r = 0; r < rows; ++r) u.push_back(static_cast<double>(batch.data(r)[k]));
    return std::pair(cost(u), false);
  });
  const auto noise = [&](int solve, int stage, int samples) {  // normal values of a stage of a solve
    SequenceBatch z(horizon, inputs, samples);
    fill_normal(z, 0, z.stride(),
                {seed, static_cast<std::uint64_t>(solve) << 16 | static_cast<std::uint64_t>(stage)});
    return z;
  };

  Json record{{"K", paper.K},
              {"L", paper.L},
              {"N", paper.N},
              {"lambda", paper.lambda},
              {"epsilon", paper.epsilon},
              {"Sigma_g", paper.Sigma_g},
              {"Sigma_0", paper.Sigma_0},
              {"Sigma_min", paper.Sigma_min},
              {"Sigma_max", paper.Sigma_max}};
  const SequenceBatch first = noise(0, 0, guides);
  for (int k = 0; k < guides; ++k) {
    paper.V_g.emplace_back();
    for (int r = 0; r < rows; ++r)
      paper.V_g.back().push_back(std::sqrt(paper.Sigma_0) * static_cast<double>(first.data(r)[k]));
    record["V_g"].push_back(recorded(paper.V_g.back()));
  }
  paper.U_tilde = paper.U_hat = reference::Sequence(static_cast<std::size_t>(rows), 0);
  for (int solve = 0; solve < solves; ++solve) {
    const int block = padded(paper.N + 1);  // samples of a guide, and the guide itself
    const SequenceBatch samples = noise(solve, 1, paper.K);
    std::vector<SequenceBatch> around_guides;
    for (int l = 0; l < paper.L; ++l) around_guides.push_back(noise(solve, 2 + l, guides * block));
    Json used = Json::array();  // in the order in which the method draws them
    paper.solve(cost, [&](int l, int k, int i, int r) {
      const double z = k < 0 ? samples.data(r)[i] : around_guides[l].data(r)[k * block + i];
      used.push_back(rounded(z));
      return z;
    });
    const SolveResult& result = solver->solve(evaluator, {});
    EXPECT_EQ(result.status, Status::ok);
    expect_near(result.nominal, paper.U_tilde, "nominal sequence", solve);
    expect_near(result.variances, paper.Sigma, "variance", solve);
    expect_near(result.inputs, paper.U_hat, "solution", solve);
    record["solves"].push_back({{"normals", used},
                                {"U_tilde", recorded(paper.U_tilde)},
                                {"Sigma", recorded(paper.Sigma)},
                                {"U_hat", recorded(paper.U_hat)}});
  }
  return record;
}

reference::SvgMppi settings(int K, int L, int N, double epsilon) {
  reference::SvgMppi paper{.K = K, .L = L, .N = N, .lambda = 2, .epsilon = epsilon};
  paper.Sigma_g = 0.3;
  paper.Sigma_0 = 0.8;
  paper.Sigma_min = 0.005;
  paper.Sigma_max = 0.9;
  return paper;
}

TEST(SvgMppi, IsThatOfThePaper) {
  solve_with_both(settings(300, 6, 40, 0.1), 8, 3, 4);
}

/// A number or a list of numbers is near the recorded one.
void expect_recorded(const Json& now, const Json& before, const std::string& what) {
  ASSERT_EQ(now.size(), before.size()) << what;
  if (now.is_number()) {
    EXPECT_NEAR(now.get<double>(), before.get<double>(), 1e-5) << what;
  } else {
    for (const auto& [key, value] : now.items())
      expect_recorded(value, now.is_object() ? before.at(key) : before.at(std::stoul(key)), what + "." + key);
  }
}

/// SLALOM_RECORD writes the file anew.
TEST(SvgMppi, HasTheRecordedFigures) {
  const Json now = solve_with_both(settings(24, 4, 12, 0.15), 4, 2, 2);
  if (std::getenv("SLALOM_RECORD")) std::ofstream(SLALOM_REFERENCE "/svg_mppi.json") << now.dump() << "\n";
  std::ifstream file(SLALOM_REFERENCE "/svg_mppi.json");
  ASSERT_TRUE(file);
  expect_recorded(now, Json::parse(file), "");
}

}  // namespace
}  // namespace slalom
