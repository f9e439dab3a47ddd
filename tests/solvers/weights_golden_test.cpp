#include "solvers/golden_json.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/methods/reverse_weights.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::testing {
namespace {

TEST(SolverGolden, Softmax) {
  int shifted = 0;
  compare_cases("softmax", [&](const Json& json, Comparison& comparison) {
    auto exact = numbers<double>(json["costs"]);
    // Costs whose differences float32 cannot tell, for their size, are given relative to the least: the
    // weights do not depend on a common offset.
    const double min_cost = *std::min_element(exact.begin(), exact.end());
    const double resolution =
        std::numeric_limits<float>::epsilon() * std::abs(min_cost) / number(json["lambda"]);
    if (resolution > 0.1 * 1e-4) {
      for (double& cost : exact) cost -= min_cost;
      comparison.note(std::to_string(++shifted) + " of them relative to the least cost, for their precision");
    }
    std::vector<float> costs(exact.begin(), exact.end());
    costs.resize((costs.size() + simd::padding - 1) / simd::padding * simd::padding,
                 std::numeric_limits<float>::infinity());
    std::vector<float> weights(costs.size());
    const detail::Range range{0, static_cast<int>(costs.size())};
    const float least = detail::kernels::minimum(costs.data(), range);
    const auto sums = detail::kernels::exponential_weights(
        costs.data(), costs.data(), least, static_cast<float>(number(json["lambda"])), range, weights.data());
    detail::kernels::scale(1.0f / (sums.weight + 1e-10f), range, weights.data());
    comparison.compare(weights, numbers<double>(json["weights"]), case_name(json));
  });
}

TEST(SolverGolden, ControlTerm) {
  compare_cases("control_term", [&](const Json& json, Comparison& comparison) {
    Batch samples(json["samples"]);
    const auto mean = numbers<float>(json["mean"]), nominal = numbers<float>(json["nominal"]);
    const auto variance = numbers<float>(json["cov"]);
    std::vector<float> coefficients(mean.size());
    detail::control_coefficients(number(json["lambda"]), number(json["alpha"]), 1e-4, mean.data(),
                                 nominal.data(), variance.data(), samples.rows, coefficients.data());
    auto costs = padded_numbers(json["costs"], 0);
    detail::kernels::add_linear(samples.view(), coefficients.data(), samples.range(), costs.data());
    comparison.compare(costs, numbers<double>(json["costs_with_control_term"]), case_name(json));
  });
}

TEST(SolverGolden, GaussianFitting) {
  int undetermined = 0;
  const auto compare = [&](const Json& json, Comparison& comparison) {
    const auto x = numbers<double>(json["x"]), y = numbers<double>(json["y"]);
    const auto fit = published_fit(x, y);
    const double fitted = std::sqrt(detail::fitted_variance(fit, true)), expected = number(json["variance"]);
    EXPECT_EQ(std::isinf(fitted), std::isinf(expected)) << case_name(json) << ": the rank decision differs";
    if (std::isinf(expected))
      comparison.note(std::to_string(++undetermined) + " of them undetermined, every decision equal");
    comparison.compare<double>({std::clamp(fitted, 0.001, 0.1)}, {std::clamp(expected, 0.001, 0.1)},
                               case_name(json), 1);
    if (number(json["cond_A"]) < 1e8) {
      EXPECT_NEAR(std::clamp(fitted, 0.001, 0.1), std::clamp(expected, 0.001, 0.1), 1e-11) << case_name(json);
    }
  };
  compare_cases("gaussian_fitting", compare, ", clamped (double)");
}

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

}  // namespace
}  // namespace slalom::testing
