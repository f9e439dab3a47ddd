#include "solvers/golden_json.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/methods/mirror_descent.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::testing {
namespace {

void compare_softmax(const std::filesystem::path& folder) {
  Comparison comparison("softmax (float32)", 1e-4);
  int shifted = 0;
  for_each_line(folder / "cases.jsonl", [&](const Json& json) {
    comparison.next_case();
    auto exact = numbers<double>(json["costs"]);
    // Costs whose differences float32 cannot tell, for their size, are given relative to the least: the
    // weights do not depend on a common offset.
    const double min_cost = *std::min_element(exact.begin(), exact.end());
    const double resolution =
        std::numeric_limits<float>::epsilon() * std::abs(min_cost) / number(json["lambda"]);
    if (resolution > 0.1 * 1e-4) {
      for (double& cost : exact) cost -= min_cost;
      ++shifted;
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
  comparison.note(std::to_string(shifted) +
                  " of them beyond the precision, taken relative to the least cost");
  EXPECT_GT(comparison.cases(), 0);
}

TEST(SolverGolden, Softmax) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/softmax");
  compare_softmax(folder);
}

void compare_control_term(const std::filesystem::path& folder) {
  Comparison comparison("control_term (float32)", 1e-4);
  for_each_line(folder / "cases.jsonl", [&](const Json& json) {
    comparison.next_case();
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
  EXPECT_GT(comparison.cases(), 0);
}

TEST(SolverGolden, ControlTerm) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/control_term");
  compare_control_term(folder);
}

TEST(SolverGolden, GaussianFitting) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/gaussian_fitting");
  Comparison comparison("gaussian_fitting, clamped (double)", 1e-4);
  int undetermined = 0;
  for_each_line(folder / "cases.jsonl", [&](const Json& json) {
    comparison.next_case();
    const auto x = numbers<double>(json["x"]), y = numbers<double>(json["y"]);
    const auto fit = published_fit(x, y);
    const double fitted = std::sqrt(detail::fitted_variance(fit, true)), expected = number(json["variance"]);
    EXPECT_EQ(std::isinf(fitted), std::isinf(expected)) << case_name(json) << ": the rank decision differs";
    undetermined += std::isinf(expected);
    comparison.compare<double>({std::clamp(fitted, 0.001, 0.1)}, {std::clamp(expected, 0.001, 0.1)},
                               case_name(json), 1);
    if (number(json["cond_A"]) < 1e8) {
      EXPECT_NEAR(std::clamp(fitted, 0.001, 0.1), std::clamp(expected, 0.001, 0.1), 1e-11) << case_name(json);
    }
  });
  comparison.note(std::to_string(undetermined) + " of them undetermined, every decision equal");
  EXPECT_GT(comparison.cases(), 0);
}

void compare_mirror_descent(const std::filesystem::path& folder) {
  Comparison comparison("md_update (float32)", 1e-4);
  for_each_line(folder / "cases.jsonl", [&](const Json& json) {
    comparison.next_case();
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
  EXPECT_GT(comparison.cases(), 0);
}

TEST(SolverGolden, MirrorDescent) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/md_update");
  compare_mirror_descent(folder);
}

}  // namespace
}  // namespace slalom::testing
