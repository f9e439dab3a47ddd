#include "solvers/methods/mppi_update.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "solvers/sampling/seek_temperature.hpp"

namespace slalom::detail {

WeightSums<double> Weighting::weigh(SampleSet& samples, float least, ThreadPool& pool) noexcept {
  return samples.weigh(least, static_cast<float>(temperature_), pool);
}

WeightSums<double> Weighting::seek(SampleSet& samples, ThreadPool& pool, int outsiders) noexcept {
  const double wanted =
      std::max(share_ > 0 ? share_ * samples.samples() : default_effective_size(samples.samples()), 1.0);
  const float least = samples.mix_totals(0, pool);
  const double scale = mean_excess(samples.totals(), least);
  const auto weigh_at = [&](double temperature) {
    temperature_ = temperature;
    return weigh(samples, samples.mix_totals(static_cast<float>(temperature), pool), pool);
  };
  if (!(scale > 0)) return weigh_at(given_temperature_ > 0 ? given_temperature_ : 1.0);
  const double found = seek_temperature(wanted, scale, temperature_, [&](double temperature) {
    const WeightSums<double> sums = weigh_at(temperature);
    return (outsiders > 0 ? samples.sum_weights(samples.samples() - outsiders) : sums).effective();
  });
  return weigh_at(found);
}

/// Computes the coefficients of the control term. Correlated samples have the covariance D C D, where D holds
/// their standard deviations and C their correlations.
void MppiUpdate::set_control_term(double temperature, const float* mean, const float* nominal,
                                  const float* variance) noexcept {
  control_coefficients(temperature, discount_, inverse_variance_offset_, mean, nominal, variance,
                       samples_.rows(), linear_.data());
  if (!samples_.shape().correlated()) return;
  const double factor = temperature * (1.0 - discount_);
  const auto scaled = [&](std::size_t r, double value) {
    return deviation_[r] > 0 ? value / deviation_[r] : 0.0;
  };
  const auto difference = [&](std::size_t r) {
    const double u = mean[r], n = nominal[r];
    return u - n;
  };
  for (std::size_t r = 0; r < sums_.size(); ++r) sums_[r] = scaled(r, difference(r));
  samples_.shape().whiten_twice(sums_.data());
  for (std::size_t r = 0; r < sums_.size(); ++r) {
    const double offset = deviation_[r] > 0 ? inverse_variance_offset_ * difference(r) : 0.0;
    linear_[r] = static_cast<float>(factor * (scaled(r, sums_[r]) + offset));
  }
}

Status MppiUpdate::update(const BatchEvaluator& evaluator, RandomKey key, const float* nominal,
                          const float* variance, const float* low, const float* high, ThreadPool& pool,
                          const Deadline& deadline, float* mean, SolveResult& result,
                          int outsiders) noexcept {
  const std::size_t rows = deviation_.size();
  for (std::size_t r = 0; r < rows; ++r) deviation_[r] = std::sqrt(variance[r]);
  // If the temperature is adapted, the control term is stored separately, in units of the temperature.
  const bool seeks = weighting_.seeks();
  set_control_term(seeks ? 1.0 : weighting_.temperature(), mean, nominal, variance);
  const int zero_mean_from = saturate_cast<int>((1.0 - zero_mean_share_) * samples_.samples());
  const BatchStatistics statistics =
      samples_.draw_and_evaluate(evaluator, key, {mean, deviation_.data(), low, high, zero_mean_from},
                                 seeks ? nullptr : linear_.data(), pool, deadline);

  result.times.draw += statistics.draw_time;
  result.times.evaluate += statistics.evaluate_time;
  const auto evaluated = Clock::now();
  WeightSums<double> sums;
  if (statistics.finite > 0) {
    if (seeks) {
      samples_.keep_terms(linear_.data(), pool);
      sums = weighting_.seek(samples_, pool, outsiders);
    } else {
      sums = weighting_.weigh(samples_, statistics.minimum_total, pool);
    }
    const double normaliser = 1.0 / (sums.weight + normaliser_offset_);
    samples_.weighted_sums(zero_.data(), sums_.data(), pool, normaliser);
    std::copy(sums_.begin(), sums_.end(), mean);
    for (std::size_t r = 0; r < rows; ++r) mean[r] = std::clamp(mean[r], low[r], high[r]);
  } else {
    std::fill(samples_.weights().begin(), samples_.weights().end(), 0.0f);
  }
  report_samples(samples_, statistics, sums, result);
  result.temperature = weighting_.temperature();
  result.times.update += seconds(evaluated, Clock::now());
  if (statistics.evaluated < samples_.samples()) return Status::deadline;
  if (statistics.finite == 0) return Status::degenerate;
  return statistics.collided == samples_.samples() ? Status::all_collided : Status::ok;
}

}  // namespace slalom::detail
