#include "solvers/golden_json.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/methods/stein.hpp"
#include "solvers/published/published_program.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::testing {
namespace {

/// Gradients so small that the published program's floor has swallowed them count as zero.
constexpr double swallowed = 1e-12;

TEST(SolverGolden, SvgGradient) {
  compare_cases("svg_grad", [&](const Json& json, Comparison& comparison) {
    Batch samples(json["grad_samples"]);
    auto totals = padded_numbers(json["grad_sample_costs"], 0);
    const auto centre = numbers<float>(json["particle"]), previous = numbers<float>(json["prev_control_seq"]);
    const auto inverse = numbers<float>(json["grad_sampler_inv_cov"]);
    auto weight = numbers<float>(json["guide_inv_cov"]);
    const float temperature = static_cast<float>(number(json["grad_lambda"]));
    for (float& w : weight) w *= temperature;
    std::vector<float> weights(totals.size()), gradient(centre.size());
    const detail::SurrogateGradient how{.temperature = temperature,
                                        .subtract_minimum = false,
                                        .floor = 1e-10,
                                        .centre = centre.data(),
                                        .inverse_variance = inverse.data(),
                                        .distance_centre = previous.data(),
                                        .distance_weight = weight.data()};
    detail::surrogate_gradient(how, samples.view(), samples.range(), samples.samples, totals.data(),
                               weights.data(), gradient.data());
    comparison.compare(gradient, numbers<double>(json["grad_log_likelihood"]), case_name(json), swallowed);
  });
}

TEST(SolverGolden, SvMpcGradient) {
  compare_cases("svmpc_grad", [&](const Json& json, Comparison& comparison) {
    // One particle: its samples stand a whole padding apart.
    const int count = static_cast<int>(json["grad_samples"].size());
    const auto centre = numbers<float>(json["particle"]), mean = numbers<float>(json["prior_mean"]);
    const int rows = static_cast<int>(centre.size());
    Batch samples(rows, count * simd::padding), theta(rows, 1), gradient(rows, 1);
    std::vector<float> exponents(static_cast<std::size_t>(samples.stride)), linear(mean.size());
    for (int s = 0; s < count; ++s) {
      const auto i = static_cast<std::size_t>(s);
      exponents[i * simd::padding] = static_cast<float>(number(json["grad_sample_costs"][i]));
      for (int r = 0; r < rows; ++r)
        samples.view().row(r)[s * simd::padding] =
            static_cast<float>(number(json["grad_samples"][i][static_cast<std::size_t>(r)]));
    }
    for (int r = 0; r < rows; ++r) theta.view().row(r)[0] = centre[static_cast<std::size_t>(r)];
    const auto inverse = numbers<float>(json["grad_sampler_inv_cov"]),
               prior_inverse = numbers<float>(json["prior_inv_cov"]);
    for (std::size_t r = 0; r < linear.size(); ++r) linear[r] = mean[r] * prior_inverse[r];
    const detail::GradientSettings how{
        count,         simd::padding, static_cast<float>(number(json["lambda"])), false, 1e-10f,
        linear.data(), inverse.data()};
    detail::kernels::particle_gradients(how, samples.view(), theta.view(), theta.range(), exponents.data(),
                                        gradient.view());
    comparison.compare(gradient.sequence(0), numbers<double>(json["grad_log_likelihood"]), case_name(json),
                       swallowed);
    std::vector<float> prior(centre.size());
    for (std::size_t r = 0; r < prior.size(); ++r)
      prior[r] = detail::published_prior_gradient(centre[r], mean[r], prior_inverse[r]);
    comparison.compare(prior, numbers<double>(json["grad_log_prior_as_called"]), case_name(json) + " prior");
  });
}

TEST(SolverGolden, SvMpcPhi) {
  compare_cases("svmpc_phi", [&](const Json& json, Comparison& comparison) {
    Batch x(json["samples"]), gradient(json["grad"]), phi(x.rows, x.samples);
    std::vector<float> norms(static_cast<std::size_t>(x.samples));
    const int count = detail::squared_norms(x.view(), x.samples, norms.data());
    const float h = detail::bandwidth(norms.data(), count, x.samples);
    comparison.compare<float>({h}, {number(json["bandwidth_h"])}, case_name(json) + " bandwidth");
    detail::kernels::stein_directions(x.view(), gradient.view(), x.samples, h, x.range(), phi.view());
    for (int i = 0; i < x.samples; ++i) {
      comparison.compare(phi.sequence(i), numbers<double>(json["phi"][static_cast<std::size_t>(i)]),
                         case_name(json) + " particle " + std::to_string(i));
    }
    // The kernel alone: two particles, one of them with a gradient of one.
    Batch pair(x.rows, 2), ones(x.rows, 2), zeros(x.rows, 2), out(x.rows, 2);
    for (int r = 0; r < x.rows; ++r) {
      pair.view().row(r)[0] = x.view().row(r)[0];
      pair.view().row(r)[1] = x.view().row(r)[1];
      ones.view().row(r)[0] = 1;
    }
    detail::kernels::stein_directions(pair.view(), zeros.view(), 2, h, pair.range(), out.view());
    auto repulsion = out.sequence(1);  // half of grad_{x0} k(x0, x1)
    for (float& v : repulsion) v *= 2;
    // The repulsion is a summand of phi and as exact as that: particles may differ by less than float32
    // tells.
    double scale = 0;
    for (const Json& direction : json["phi"])
      for (const double entry : numbers<double>(direction)) scale = std::max(scale, std::abs(entry));
    comparison.compare(repulsion, numbers<double>(json["grad_kernel_01"]), case_name(json) + " grad kernel",
                       scale);
    detail::kernels::stein_directions(pair.view(), ones.view(), 2, h, pair.range(), out.view());
    const auto with_gradient = out.sequence(1);
    comparison.compare<float>({2 * with_gradient[0] - repulsion[0]}, {number(json["kernel_01"])},
                              case_name(json) + " kernel", 1);
  });
}

}  // namespace
}  // namespace slalom::testing
