#include "solvers/golden_json.hpp"
#include "solvers/methods/reverse_weights.hpp"
#include "solvers/published/published_program.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::testing {
namespace {

bool any_nan(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
}

/// Weighted mean, and the published program's dimensionless second moment about the samples' mean.
void compare_moments(const Json& json, const char* suffix, Batch& samples, const std::vector<float>& weights,
                     Comparison& comparison) {
  const auto expected_mean = numbers<double>(json[std::string("mean_") + suffix]);
  if (any_nan(expected_mean)) return;
  const auto prior = numbers<float>(json["mean"]), variance = numbers<float>(json["cov"]);
  const std::vector<float> zero(prior.size());
  std::vector<float> mean(prior.size()), sigma(prior.size());
  detail::kernels::weighted_sums(samples.view(), weights.data(), zero.data(), samples.range(), mean.data());
  detail::kernels::weighted_squares(samples.view(), weights.data(), prior.data(), samples.range(),
                                    sigma.data());
  for (std::size_t r = 0; r < sigma.size(); ++r) sigma[r] *= detail::inverse_variance(variance[r], 1e-4f);
  comparison.compare(mean, expected_mean, case_name(json) + " mean_" + suffix);
  comparison.compare(sigma, numbers<double>(json[std::string("sigma_") + suffix]),
                     case_name(json) + " sigma_" + suffix);
}

/// Plain mean and variance of the samples.
void compare_plain_moments(const Json& json, Batch& samples, Comparison& comparison) {
  std::vector<float> weights(static_cast<std::size_t>(samples.stride)), mean(json["mean"].size()),
      variance(mean.size());
  std::fill_n(weights.begin(), samples.samples, 1.0f / static_cast<float>(samples.samples));
  const std::vector<float> zero(mean.size());
  detail::kernels::weighted_sums(samples.view(), weights.data(), zero.data(), samples.range(), mean.data());
  detail::kernels::weighted_squares(samples.view(), weights.data(), mean.data(), samples.range(),
                                    variance.data());
  for (float& v : variance) v += 1e-5f;
  comparison.compare(mean, numbers<double>(json["est_mu"]), case_name(json) + " est_mu");
  comparison.compare(variance, numbers<double>(json["est_sigma"]), case_name(json) + " est_sigma");
}

TEST(SolverGolden, ReverseWeights) {
  int overflown = 0;
  compare_cases("reverse_weights", [&](const Json& json, Comparison& comparison) {
    Batch samples(json["samples"]);
    const auto mean = numbers<float>(json["mean"]), variance = numbers<float>(json["cov"]);
    const std::vector<float> nominal(mean.size());
    std::vector<float> coefficients(mean.size());
    const double temperature = number(json["lambda"]);
    detail::control_coefficients(temperature, number(json["alpha"]), 1e-4, mean.data(), nominal.data(),
                                 variance.data(), samples.rows, coefficients.data());
    auto totals = padded_numbers(json["costs"], std::numeric_limits<float>::infinity());
    detail::kernels::add_linear(samples.view(), coefficients.data(), samples.range(), totals.data());
    std::vector<float> evaluated(totals.size()), rejected(totals.size());
    const auto sums = detail::reverse_weights(totals.data(), static_cast<float>(temperature),
                                              static_cast<float>(number(json["negative_ratio"])), 1e-10f,
                                              samples.range(), evaluated.data(), rejected.data());
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
    Batch samples(json["samples"]);
    const auto mean = numbers<float>(json["mean"]), variance = numbers<float>(json["cov"]);
    const auto rejected = numbers<float>(json["rejected_mean"]),
               rejected_variance = numbers<float>(json["rejected_cov"]);
    detail::PublishedRejection densities(static_cast<int>(mean.size()));
    densities.set(mean.data(), variance.data(), rejected.data(), rejected_variance.data());
    std::vector<float> base(densities.base(), densities.base() + mean.size());
    comparison.compare(base, numbers<double>(json["normal_pdf_rejected_mean"]), case_name(json) + " base");
    std::vector<float> first;
    for (int r = 0; r < samples.rows; ++r) {
      const auto i = static_cast<std::size_t>(r);
      first.push_back(detail::published_density(samples.view().row(r)[0], rejected[i], rejected_variance[i]));
    }
    comparison.compare(first, numbers<double>(json["normal_pdf_sample0"]), case_name(json) + " sample 0");

    std::vector<float> logarithms(static_cast<std::size_t>(samples.stride));
    detail::kernels::published_rejection(samples.view(), densities.rows(), samples.range(),
                                         logarithms.data());
    // The program divides by min(sum, 1e-10); only ratios matter, so both are compared as ratios to the
    // whole.
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

}  // namespace
}  // namespace slalom::testing
