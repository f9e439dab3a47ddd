#include "solvers/golden_json.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/methods/mppi_update.hpp"
#include "solvers/sampling/sample_set.hpp"

/// Whole solves of the published SVG-MPPI, stage by stage, each stage from what the trace says went into it.
namespace slalom::testing {
namespace {

// The parameters of the traces.
constexpr double temperature = 3, discount = 0.1, gradient_temperature = 3, guide_step = 0.005,
                 fit_temperature = 0.1, variance_min = 0.001, variance_max = 0.1, offset = 1e-10;

/// A column of a CSV file with a header, by name.
std::vector<double> column(const std::filesystem::path& path, const std::string& name) {
  std::ifstream file(path);
  std::string line, field;
  std::getline(file, line);
  std::vector<std::string> names;
  for (std::istringstream header(line); std::getline(header, field, ',');) names.push_back(field);
  const auto at = std::find(names.begin(), names.end(), name) - names.begin();
  std::vector<double> values;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    for (std::ptrdiff_t i = 0; i <= at; ++i) std::getline(row, field, ',');
    values.push_back(std::stod(field));
  }
  return values;
}

/// The guides' gradients and steps of every iteration.
void compare_transport(const Json& solve, const std::string& where, Comparison& comparison) {
  const auto previous = numbers<float>(solve["prev_control_seq"]);
  auto weight = numbers<float>(solve["guide_inv_cov"]);
  const std::vector<float> inverse(weight.size(), detail::inverse_variance(0.01f, 1e-4f));
  for (float& w : weight) w *= static_cast<float>(gradient_temperature);
  for (std::size_t l = 0; l < solve["svgd_iterations"].size(); ++l) {
    const Json& iteration = solve["svgd_iterations"][l];
    for (std::size_t g = 0; g < iteration["grad"].size(); ++g) {
      SequenceBatch samples = batch_of(iteration["grad_samples"][g]);
      auto totals = padded_numbers(iteration["grad_sample_costs"][g], 0);
      auto particle = numbers<float>(iteration["particles_before"][g]);
      std::vector<float> weights(totals.size()), gradient(particle.size());
      const detail::SurrogateGradient how{.temperature = static_cast<float>(gradient_temperature),
                                          .subtract_minimum = false,
                                          .floor = offset,
                                          .centre = particle.data(),
                                          .inverse_variance = inverse.data(),
                                          .distance_centre = previous.data(),
                                          .distance_weight = weight.data()};
      detail::surrogate_gradient(how, rows_of(samples), all_of(samples), samples.samples(), totals.data(),
                                 weights.data(), gradient.data());
      const std::string at = where + " iteration " + std::to_string(l) + " guide " + std::to_string(g);
      comparison.compare(gradient, numbers<double>(iteration["grad"][g]), at + " gradient", 1e-12);
      for (std::size_t r = 0; r < particle.size(); ++r)
        particle[r] += static_cast<float>(guide_step) * gradient[r];
      comparison.compare(particle, numbers<double>(iteration["particles_after"][g]), at + " guide");
    }
  }
}

/// The Gaussians fitted to the guides' paths; returns how many fits, and counts the undetermined ones.
int compare_fits(const Json& solve, const std::string& where, Comparison& comparison, int& undetermined) {
  const auto density = numbers<double>(solve["costs_history"]);
  std::vector<double> weights;
  const double least = *std::min_element(density.begin(), density.end());
  double sum = offset;
  for (const double cost : density) sum += weights.emplace_back(std::exp((least - cost) / fit_temperature));
  for (double& weight : weights) weight /= sum;
  const auto expected_weights = numbers<double>(solve["softmax_costs"]);
  for (std::size_t i = 0; i < weights.size(); ++i)
    EXPECT_NEAR(weights[i], expected_weights[i], 1e-9) << where;

  const auto expected = numbers<double>(solve["fit_sigma"]), clamped = numbers<double>(solve["covs_clamped"]);
  for (std::size_t r = 0; r < expected.size(); ++r) {
    std::vector<double> x;
    for (const Json& iteration : solve["svgd_iterations"])
      for (const Json& particle : iteration["particles_after"]) x.push_back(number(particle[r]));
    const auto fit = published_fit(x, weights);
    const double fitted = std::sqrt(detail::fitted_variance(fit, true));
    EXPECT_EQ(std::isinf(fitted), std::isinf(expected[r])) << where << " step " << r << ": rank decision";
    undetermined += std::isinf(expected[r]);
    comparison.compare<double>({std::clamp(fitted, variance_min, variance_max)}, {clamped[r]},
                               where + " step " + std::to_string(r), 1);
  }
  return static_cast<int>(expected.size());
}

/// Control term and weights of all samples, and the new solution where all samples are in the trace.
void compare_update(const Json& solve, const std::filesystem::path& csv, const std::string& where,
                    Comparison& comparison) {
  const auto costs = column(csv, "cost"), totals = column(csv, "cost_with_control_term"),
             weights = column(csv, "weight");
  ASSERT_EQ(costs.size(), solve["num_samples"].get<std::size_t>());

  SequenceBatch samples = batch_of(solve["samples_first"]);
  const std::size_t known = samples.samples();
  const auto mean = numbers<float>(solve["prev_control_seq"]),
             nominal = numbers<float>(solve["nominal_control_seq"]),
             variance = numbers<float>(solve["covs_clamped"]);
  std::vector<float> coefficients(mean.size()), with_term(costs.begin(), costs.begin() + samples.samples());
  with_term.resize(samples.stride());
  detail::control_coefficients(temperature, discount, 1e-4, mean.data(), nominal.data(), variance.data(),
                               samples.rows(), coefficients.data());
  detail::kernels::add_linear(rows_of(samples), coefficients.data(), all_of(samples), with_term.data());
  comparison.compare(with_term, {totals.begin(), totals.begin() + samples.samples()},
                     where + " control term");

  std::vector<float> all(totals.begin(), totals.end());
  all.resize(padded(static_cast<int>(all.size())), std::numeric_limits<float>::infinity());
  std::vector<float> w(all.size());
  const detail::Range range{0, static_cast<int>(all.size())};
  const float least = detail::kernels::minimum(all.data(), range);
  comparison.compare<float>({least}, {number(solve["min_cost_with_control_term"])}, where + " least cost");
  const auto sums = detail::kernels::exponential_weights(all.data(), all.data(), least,
                                                         static_cast<float>(temperature), range, w.data());
  detail::kernels::scale(1.0f / (sums.weight + static_cast<float>(offset)), range, w.data());
  comparison.compare(w, weights, where + " weights");

  if (known == costs.size()) {
    const std::vector<float> zero(mean.size());
    std::vector<float> solution(mean.size());
    detail::kernels::weighted_sums(rows_of(samples), w.data(), zero.data(), all_of(samples), solution.data());
    comparison.compare(solution, numbers<double>(solve["result_control_seq"]), where + " solution");
  }
}

TEST(SolverGolden, SvgTrace) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/svg_trace");
  Comparison solves("svg_trace (float32)", 1e-4), fits("svg_trace fits, clamped (double)", 1e-4);
  int undetermined = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!std::filesystem::exists(entry.path() / "trace.jsonl")) continue;
    for_each_line(entry.path() / "trace.jsonl", [&](const Json& solve) {
      const std::string index = std::to_string(solve["solve"].get<int>());
      const std::string where = entry.path().filename().string() + " solve " + index;
      solves.next_case();
      compare_transport(solve, where, solves);
      for (int i = compare_fits(solve, where, fits, undetermined); i > 0; --i) fits.next_case();
      const auto csv = entry.path() / ("solve" + index + "_costs.csv");
      compare_update(solve, csv, where, solves);
    });
  }
  fits.note(std::to_string(undetermined) + " of them undetermined, every decision equal");
  EXPECT_GT(solves.cases(), 0);
}

}  // namespace
}  // namespace slalom::testing
