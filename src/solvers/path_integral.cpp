#include "solvers/path_integral.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::detail {

PathIntegral::PathIntegral(const Settings& settings, int horizon, int inputs, int samples)
    : settings_(settings),
      samples_(horizon, inputs, samples),
      deviation_(static_cast<std::size_t>(samples_.rows())),
      linear_(deviation_.size()),
      zero_(deviation_.size()),
      sums_(deviation_.size()) {}

Status PathIntegral::update(const BatchEvaluator& evaluator, RandomKey key, const float* nominal,
                            const float* variance, const float* low, const float* high, ThreadPool& pool,
                            const Deadline& deadline, float* mean, SolveResult& result) noexcept {
  const std::size_t rows = deviation_.size();
  for (std::size_t r = 0; r < rows; ++r) deviation_[r] = std::sqrt(variance[r]);
  control_coefficients(settings_.temperature, settings_.discount, settings_.inverse_variance_offset, mean,
                       nominal, variance, samples_.rows(), linear_.data());
  const int zero_mean_from = static_cast<int>((1.0 - settings_.zero_mean_share) * samples_.samples());
  const Census census = samples_.draw_and_evaluate(
      evaluator, key, {mean, deviation_.data(), low, high, zero_mean_from}, linear_.data(), pool, deadline);

  const auto evaluated = Clock::now();
  WeightSums<double> sums;
  if (census.finite > 0) {
    sums = samples_.weigh(census.minimum_total, static_cast<float>(settings_.temperature), pool);
    samples_.scale_weights(1.0 / (sums.weight + settings_.normaliser_offset));
    samples_.weighted_sums(zero_.data(), sums_.data(), pool);
    for (std::size_t r = 0; r < rows; ++r) {
      mean[r] = std::clamp(static_cast<float>(sums_[r]), low[r], high[r]);
    }
  } else {
    std::fill(samples_.weights().begin(), samples_.weights().end(), 0.0f);
  }
  report_samples(samples_, census, sums, result);
  result.temperature = settings_.temperature;
  result.times.update += seconds(evaluated, Clock::now());
  if (census.evaluated < samples_.samples()) return Status::deadline;
  if (census.finite == 0) return Status::degenerate;
  return census.collided == samples_.samples() ? Status::all_collided : Status::ok;
}

}  // namespace slalom::detail
