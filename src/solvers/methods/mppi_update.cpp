#include "solvers/methods/mppi_update.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "solvers/sampling/seek_temperature.hpp"

namespace slalom::detail {

void control_coefficients(double temperature, double discount, double inverse_variance_offset,
                          const float* mean, const float* nominal, const float* variance, int rows,
                          float* coefficients) noexcept {
  const double factor = temperature * (1.0 - discount);
  for (int r = 0; r < rows; ++r) {
    const double u = mean[r], n = nominal[r];
    const double inverse = inverse_variance<double>(variance[r], inverse_variance_offset);
    coefficients[r] = static_cast<float>(factor * (u - n) * inverse);
  }
}

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
void MppiUpdate::set_control_term(double temperature, const Distribution& from) noexcept {
  control_coefficients(temperature, discount_, inverse_variance_offset_, from.mean, from.nominal,
                       from.variance, samples_.rows(), linear_.data());
  if (!samples_.shape().correlated()) return;
  const double factor = temperature * (1.0 - discount_);
  const auto scaled = [&](std::size_t r, double value) {
    return deviation_[r] > 0 ? value / deviation_[r] : 0.0;
  };
  const auto difference = [&](std::size_t r) {
    const double u = from.mean[r], n = from.nominal[r];
    return u - n;
  };
  for (std::size_t r = 0; r < sums_.size(); ++r) sums_[r] = scaled(r, difference(r));
  samples_.shape().whiten_twice(sums_.data());
  for (std::size_t r = 0; r < sums_.size(); ++r) {
    const double offset = deviation_[r] > 0 ? inverse_variance_offset_ * difference(r) : 0.0;
    linear_[r] = static_cast<float>(factor * (scaled(r, sums_[r]) + offset));
  }
}

BatchStatistics MppiUpdate::sample(const BatchEvaluator& evaluator, RandomKey key, const Distribution& from,
                                   ThreadPool& pool, const Deadline& deadline) noexcept {
  for (std::size_t r = 0; r < deviation_.size(); ++r) deviation_[r] = std::sqrt(from.variance[r]);
  // If the temperature is adapted, the control term is stored separately, in units of the temperature.
  const bool seeks = weighting_.seeks();
  set_control_term(seeks ? 1.0 : weighting_.temperature(), from);
  const int zero_mean_from = saturate_cast<int>((1.0 - zero_mean_share_) * samples_.samples());
  return samples_.draw_and_evaluate(evaluator, key,
                                    {from.mean, deviation_.data(), from.low, from.high, zero_mean_from},
                                    seeks ? nullptr : linear_.data(), pool, deadline);
}

Status MppiUpdate::move_mean(const BatchStatistics& drawn, ThreadPool& pool, float* mean, SolveResult& result,
                             int outsiders) noexcept {
  const auto start = Clock::now();
  result.times.draw += drawn.draw_time;
  result.times.evaluate += drawn.evaluate_time;
  WeightSums<double> sums;
  if (drawn.finite > 0) {
    if (weighting_.seeks()) {
      samples_.keep_terms(linear_.data(), pool);
      sums = weighting_.seek(samples_, pool, outsiders);
    } else {
      sums = weighting_.weigh(samples_, drawn.minimum_total, pool);
    }
    const double normaliser = 1.0 / (sums.weight + normaliser_offset_);
    samples_.weighted_sums(zero_.data(), sums_.data(), pool, normaliser);
    std::copy(sums_.begin(), sums_.end(), mean);
  } else {
    std::fill(samples_.weights().begin(), samples_.weights().end(), 0.0f);
  }
  report_samples(samples_, drawn, sums, result);
  result.temperature = weighting_.temperature();
  result.times.update += seconds(start, Clock::now());
  if (drawn.evaluated < samples_.samples()) return Status::deadline;
  if (drawn.finite == 0) return Status::degenerate;
  return drawn.collided == samples_.samples() ? Status::all_collided : Status::ok;
}

}  // namespace slalom::detail
