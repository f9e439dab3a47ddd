/// The parts of the solvers against those of the published program; svg_trace_golden_test.cpp has those of
/// SVG-MPPI. Whole solves of the published SVG-MPPI, each stage from what the trace says went into it.
#include "solvers/golden_json.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/methods/mppi_update.hpp"
#include "solvers/methods/reverse_weights.hpp"
#include "solvers/methods/stein.hpp"
#include "solvers/published/published_program.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::testing {
namespace {

TEST(SolverGolden, MirrorDescent) {
  compare_cases("md_update", [&](const Json& json, Comparison& comparison) {
    auto mean = numbers<float>(json["prior_mean"]), variance = numbers<float>(json["prior_cov"]);
    const auto prior_mean = mean, prior_variance = variance;
    const auto weighted_mean = numbers<float>(json["weighted_mean"]),
               weighted_variance = numbers<float>(json["weighted_cov"]);
    const int rows = static_cast<int>(mean.size());
    detail::mirror_descent(static_cast<float>(number(json["step_size"])), weighted_mean.data(),
                           weighted_variance.data(), rows, mean.data(), variance.data());
    comparison.compare(mean, numbers<double>(json["new_mean"]), case_name(json) + " mean");
    comparison.compare(variance, numbers<double>(json["new_cov"]), case_name(json) + " variance");
    const float ratio = static_cast<float>(number(json["interp_ratio"]));
    detail::interpolate(prior_mean.data(), mean.data(), ratio, rows, mean.data());
    detail::interpolate(prior_variance.data(), variance.data(), ratio, rows, variance.data());
    comparison.compare(mean, numbers<double>(json["interp_mean"]), case_name(json) + " warm mean");
    comparison.compare(variance, numbers<double>(json["interp_cov"]), case_name(json) + " warm variance");
  });
}

/// Gradients so small that the published program's floor has swallowed them count as zero.
constexpr double swallowed = 1e-12;

TEST(SolverGolden, SvMpcGradient) {
  compare_cases("svmpc_grad", [&](const Json& json, Comparison& comparison) {
    // One particle: its samples stand a whole padding apart.
    const int count = static_cast<int>(json["grad_samples"].size());
    const auto centre = numbers<float>(json["particle"]), mean = numbers<float>(json["prior_mean"]);
    const int rows = static_cast<int>(centre.size());
    SequenceBatch samples(1, rows, count * simd::padding), theta(1, rows, 1), gradient(1, rows, 1);
    std::vector<float> exponents(samples.stride()), linear(mean.size());
    for (int s = 0; s < count; ++s) {
      exponents[s * simd::padding] = static_cast<float>(number(json["grad_sample_costs"][s]));
      for (int r = 0; r < rows; ++r)
        samples.data(r)[s * simd::padding] = static_cast<float>(number(json["grad_samples"][s][r]));
    }
    for (int r = 0; r < rows; ++r) theta.data(r)[0] = centre[r];
    const auto inverse = numbers<float>(json["grad_sampler_inv_cov"]),
               prior_inverse = numbers<float>(json["prior_inv_cov"]);
    for (std::size_t r = 0; r < linear.size(); ++r) linear[r] = mean[r] * prior_inverse[r];
    const detail::GradientSettings how{
        count,         simd::padding, static_cast<float>(number(json["lambda"])), false, 1e-10f,
        linear.data(), inverse.data()};
    detail::kernels::particle_gradients(how, rows_of(samples), rows_of(theta), all_of(theta),
                                        exponents.data(), rows_of(gradient));
    comparison.compare(sequence(gradient, 0), numbers<double>(json["grad_log_likelihood"]), case_name(json),
                       swallowed);
    std::vector<float> prior(centre.size());
    for (std::size_t r = 0; r < prior.size(); ++r)
      prior[r] = detail::published_prior_gradient(centre[r], mean[r], prior_inverse[r]);
    comparison.compare(prior, numbers<double>(json["grad_log_prior_as_called"]), case_name(json) + " prior");
  });
}

TEST(SolverGolden, SvMpcPhi) {
  compare_cases("svmpc_phi", [&](const Json& json, Comparison& comparison) {
    SequenceBatch x = batch_of(json["samples"]), gradient = batch_of(json["grad"]),
                  phi(1, x.rows(), x.samples());
    std::vector<float> norms(x.samples());
    const int count = detail::squared_norms(rows_of(x), x.samples(), norms.data());
    const float h = detail::bandwidth(norms.data(), count, x.samples());
    comparison.compare<float>({h}, {number(json["bandwidth_h"])}, case_name(json) + " bandwidth");
    detail::kernels::stein_directions(rows_of(x), rows_of(gradient), x.samples(), h, all_of(x), rows_of(phi));
    for (int i = 0; i < x.samples(); ++i) {
      comparison.compare(sequence(phi, i), numbers<double>(json["phi"][i]),
                         case_name(json) + " particle " + std::to_string(i));
    }
    // The kernel alone: two particles, one of them with a gradient of one.
    SequenceBatch pair(1, x.rows(), 2), ones = pair, zeros = pair, out = pair;
    for (int r = 0; r < x.rows(); ++r) {
      pair.data(r)[0] = x.data(r)[0];
      pair.data(r)[1] = x.data(r)[1];
      ones.data(r)[0] = 1;
    }
    detail::kernels::stein_directions(rows_of(pair), rows_of(zeros), 2, h, all_of(pair), rows_of(out));
    auto repulsion = sequence(out, 1);  // half of grad_{x0} k(x0, x1)
    for (float& v : repulsion) v *= 2;
    // The repulsion is a summand of phi as exact as that: particles may differ by less than float32 tells.
    double scale = 0;
    for (const Json& direction : json["phi"])
      for (const double entry : numbers<double>(direction)) scale = std::max(scale, std::abs(entry));
    comparison.compare(repulsion, numbers<double>(json["grad_kernel_01"]), case_name(json) + " grad kernel",
                       scale);
    detail::kernels::stein_directions(rows_of(pair), rows_of(ones), 2, h, all_of(pair), rows_of(out));
    const auto with_gradient = sequence(out, 1);
    comparison.compare<float>({2 * with_gradient[0] - repulsion[0]}, {number(json["kernel_01"])},
                              case_name(json) + " kernel", 1);
  });
}

bool any_nan(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
}

/// Weighted mean, and the published program's dimensionless second moment about the samples' mean.
void compare_moments(const Json& json, const char* suffix, SequenceBatch& samples,
                     const std::vector<float>& weights, Comparison& comparison) {
  const auto expected_mean = numbers<double>(json[std::string("mean_") + suffix]);
  if (any_nan(expected_mean)) return;
  const auto prior = numbers<float>(json["mean"]), variance = numbers<float>(json["cov"]);
  const std::vector<float> zero(prior.size());
  std::vector<float> mean(prior.size()), sigma(prior.size());
  detail::kernels::weighted_sums(rows_of(samples), weights.data(), zero.data(), all_of(samples), mean.data());
  detail::kernels::weighted_squares(rows_of(samples), weights.data(), prior.data(), all_of(samples),
                                    sigma.data());
  for (std::size_t r = 0; r < sigma.size(); ++r) sigma[r] *= detail::inverse_variance(variance[r], 1e-4f);
  comparison.compare(mean, expected_mean, case_name(json) + " mean_" + suffix);
  comparison.compare(sigma, numbers<double>(json[std::string("sigma_") + suffix]),
                     case_name(json) + " sigma_" + suffix);
}

/// Plain mean and variance of the samples.
void compare_plain_moments(const Json& json, SequenceBatch& samples, Comparison& comparison) {
  std::vector<float> weights(samples.stride()), mean(json["mean"].size()), variance(mean.size());
  std::fill_n(weights.begin(), samples.samples(), 1.0f / static_cast<float>(samples.samples()));
  const std::vector<float> zero(mean.size());
  detail::kernels::weighted_sums(rows_of(samples), weights.data(), zero.data(), all_of(samples), mean.data());
  detail::kernels::weighted_squares(rows_of(samples), weights.data(), mean.data(), all_of(samples),
                                    variance.data());
  for (float& v : variance) v += 1e-5f;
  comparison.compare(mean, numbers<double>(json["est_mu"]), case_name(json) + " est_mu");
  comparison.compare(variance, numbers<double>(json["est_sigma"]), case_name(json) + " est_sigma");
}

TEST(SolverGolden, ReverseWeights) {
  int overflown = 0;
  compare_cases("reverse_weights", [&](const Json& json, Comparison& comparison) {
    SequenceBatch samples = batch_of(json["samples"]);
    const auto mean = numbers<float>(json["mean"]), variance = numbers<float>(json["cov"]);
    const std::vector<float> nominal(mean.size());
    std::vector<float> coefficients(mean.size());
    const double temperature = number(json["lambda"]);
    detail::control_coefficients(temperature, number(json["alpha"]), 1e-4, mean.data(), nominal.data(),
                                 variance.data(), samples.rows(), coefficients.data());
    auto totals = padded_numbers(json["costs"], std::numeric_limits<float>::infinity());
    detail::kernels::add_linear(rows_of(samples), coefficients.data(), all_of(samples), totals.data());
    std::vector<float> evaluated(totals.size()), rejected(totals.size());
    const auto sums = detail::reverse_weights(totals.data(), static_cast<float>(temperature),
                                              static_cast<float>(number(json["negative_ratio"])), 1e-10f,
                                              all_of(samples), evaluated.data(), rejected.data());
    const auto expected = numbers<double>(json["weights_eval"]),
               expected_rejected = numbers<double>(json["weights_reject"]);
    const bool published_nan = any_nan(expected) || any_nan(expected_rejected);
    // Where the published program overflows or divides by zero ours has finite weights, and says so.
    EXPECT_EQ(published_nan, sums.log_growth > 709.78 || sums.evaluated == 0 || sums.rejected == 0)
        << case_name(json) << " log growth " << sums.log_growth;
    if (published_nan) comparison.note(std::to_string(++overflown) + " of them NaN in the published program");
    for (const float w : evaluated) EXPECT_TRUE(std::isfinite(w));
    if (!any_nan(expected)) comparison.compare(evaluated, expected, case_name(json) + " evaluated");
    if (!any_nan(expected_rejected))
      comparison.compare(rejected, expected_rejected, case_name(json) + " rejected");
    compare_moments(json, "eval", samples, evaluated, comparison);
    compare_moments(json, "reject", samples, rejected, comparison);
    compare_plain_moments(json, samples, comparison);
  });
}

TEST(SolverGolden, RejectionProbability) {
  compare_cases("rejection_prob", [&](const Json& json, Comparison& comparison) {
    SequenceBatch samples = batch_of(json["samples"]);
    const auto mean = numbers<float>(json["mean"]), variance = numbers<float>(json["cov"]);
    const auto rejected = numbers<float>(json["rejected_mean"]),
               rejected_variance = numbers<float>(json["rejected_cov"]);
    detail::PublishedRejection densities(static_cast<int>(mean.size()));
    densities.set(mean.data(), variance.data(), rejected.data(), rejected_variance.data());
    std::vector<float> base(densities.base(), densities.base() + mean.size());
    comparison.compare(base, numbers<double>(json["normal_pdf_rejected_mean"]), case_name(json) + " base");
    std::vector<float> first;
    for (int r = 0; r < samples.rows(); ++r)
      first.push_back(detail::published_density(samples.data(r)[0], rejected[r], rejected_variance[r]));
    comparison.compare(first, numbers<double>(json["normal_pdf_sample0"]), case_name(json) + " sample 0");

    std::vector<float> logarithms(samples.stride());
    detail::kernels::published_rejection(rows_of(samples), densities.rows(), all_of(samples),
                                         logarithms.data());
    // The program divides by min(sum, 1e-10); only ratios matter, so both are compared as shares.
    std::vector<double> raw, expected = numbers<double>(json["prob_raw"]);
    for (std::size_t k = 0; k < expected.size(); ++k)
      raw.push_back(std::exp(-static_cast<double>(logarithms[k])));
    comparison.compare(raw, expected, case_name(json) + " probabilities");
    double sum = 0;
    for (const double p : raw) sum += p;
    for (double& p : raw) p /= std::min(sum, 1e-10);
    comparison.compare(raw, numbers<double>(json["prob_normalised_as_in_code"]),
                       case_name(json) + " as coded");
  });
}

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
