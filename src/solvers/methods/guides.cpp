#include "solvers/methods/guides.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "solvers/methods/gaussian_fit.hpp"
#include "solvers/sampling/seek_temperature.hpp"

namespace slalom::detail {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// A value for each row, from one for each input.
std::vector<float> spread(const PerInput& values, int horizon, int inputs) {
  std::vector<float> rows(horizon * inputs);
  for (int r = 0; r < horizon * inputs; ++r) rows[r] = static_cast<float>(values[r % inputs]);
  return rows;
}

}  // namespace

bool surrogate_gradient(const SurrogateGradient& s, const Rows& v, Range block, int samples, float* totals,
                        float* weights, float* gradient) noexcept {
  if (s.linear) kernels::add_linear(v, s.linear, block, totals);
  if (s.distance_centre)
    kernels::add_squared_distance(v, s.distance_centre, s.distance_weight, block, totals);
  kernels::make_finite(block, totals);
  std::fill(totals + block.first + samples, totals + block.first + block.count, infinite);
  const float least = kernels::minimum(totals, block);
  if (!(least < infinite)) {
    std::fill_n(gradient, v.rows, 0.0f);
    return false;
  }
  const auto weigh = [&](double temperature) {
    return kernels::exponential_weights(totals, totals, least, static_cast<float>(temperature), block,
                                        weights);
  };
  const auto effective_size = [&](double t) { return weigh(t).effective(); };
  const double temperature =
      s.temperature > 0 ? s.temperature
                        : default_temperature({totals + block.first, static_cast<std::size_t>(samples)},
                                              least, effective_size);
  const double sum = weigh(temperature).weight;
  const double floor = s.subtract_minimum ? s.floor : s.floor * std::exp(least / temperature);
  kernels::weighted_sums(v, weights, s.centre, block, gradient);
  for (int r = 0; r < v.rows; ++r) {
    const double moved = gradient[r];
    gradient[r] = static_cast<float>(s.inverse_variance[r] * moved / (sum + floor));
  }
  return true;
}

Guides::Guides(const SvgMppiOptions& options, int inputs, std::span<const float> low,
               std::span<const float> high)
    : options_(options),
      inputs_(inputs),
      count_(options.guides.count),
      gradient_samples_(options.guides.gradient_samples),
      block_(padded(gradient_samples_ + 1)),
      rows_(options.horizon * inputs),
      low_(low.begin(), low.end()),
      high_(high.begin(), high.end()),
      shape_(options.noise.pinned ? NoiseShape(options.noise, options.horizon, inputs) : NoiseShape()),
      theta_(count_, rows_),
      shifted_(count_, rows_),
      guides_(count_, rows_),
      batch_(options.horizon, inputs, count_ * block_),
      ends_(options.horizon, inputs, count_ + 1),
      costs_(count_ * block_),
      totals_(costs_.size()),
      weights_(costs_.size()),
      end_costs_(padded(count_ + 1)),
      collided_(costs_.size()),
      end_collided_(end_costs_.size()),
      gradient_(count_, rows_),
      deviation_(spread(options.guides.gradient_variance, options.horizon, inputs)),
      inverse_(deviation_),
      step_(spread(options.guides.step, options.horizon, inputs)),
      weight_variance_(spread(options.guides.variance, options.horizon, inputs)),
      linear_(rows_),
      distance_weight_(rows_),
      solution_(rows_),
      path_(point(options.guides.iterations, 0), rows_),
      path_float_(point(options.guides.iterations, 0), rows_),
      path_costs_(point(options.guides.iterations, 0)),
      made_(count_),
      fit_points_(path_costs_.size()),
      density_(path_costs_.size()),
      square_(path_costs_.size()),
      logarithm_(path_costs_.size()),
      abscissa_(path_costs_.size()) {
  for (int r = 0; r < rows_; ++r) {
    const double variance = deviation_[r];
    inverse_[r] = static_cast<float>(inverse_variance(variance, options_.published.inverse_variance_offset));
    deviation_[r] = static_cast<float>(std::sqrt(variance));
  }
}

void Guides::restart(RandomKey key) noexcept {
  fill_normal(ends_, 0, shape_.pinned() ? padded(count_) : count_, key);
  if (shape_.pinned()) shape_.apply(ends_, {0, padded(count_)});
  for (int g = 0; g < count_; ++g) {
    for (int r = 0; r < rows_; ++r) {
      const float z = ends_[r][g];
      theta_[g][r] = std::clamp(std::sqrt(weight_variance_[r]) * z, low_[r], high_[r]);
    }
  }
  round_to_float();
  iterations_ = 0;
  best_ = 0;
}

void Guides::shift(double steps) noexcept {
  for (int g = 0; g < count_; ++g) {
    shift_sequence(theta_[g], options_.horizon, inputs_, steps, shifted_[g]);
  }
  std::swap(theta_, shifted_);
  round_to_float();
}

void Guides::round_to_float() noexcept {
  std::copy(theta_.values().begin(), theta_.values().end(), guides_.values().begin());
}

void Guides::take_in(const BatchEvaluator& evaluator, const float* solution) noexcept {
  for (int g = 0; g < count_; ++g) ends_.set_sample(g, std::span<const float>(guides_[g], rows_));
  ends_.set_sample(count_, std::span<const float>(solution, rows_));
  evaluator.evaluate(ends_, 0, count_ + 1, end_costs_.data(), end_collided_.data());
  kernels::make_finite({0, padded(count_ + 1)}, end_costs_.data());
  const auto first = end_costs_.data(), last = first + count_;
  const int worst = static_cast<int>(std::max_element(first, last) - first);
  if (end_costs_[count_] < end_costs_[worst]) {
    std::copy_n(solution, rows_, theta_[worst]);
    std::copy_n(solution, rows_, guides_[worst]);
    end_costs_[worst] = end_costs_[count_];
  }
  best_ = static_cast<int>(std::min_element(first, last) - first);
}

/// The deviations are pinned noise, or piecewise linear between normal values a third of the horizon apart.
void Guides::restart_others(RandomKey key) noexcept {
  if (!options_.guides.restart || count_ == 1) return;
  if (best_ != 0) std::copy_n(theta_[best_], rows_, theta_[0]);
  best_ = 0;
  fill_normal(ends_, 0, padded(count_), key);
  if (shape_.pinned()) shape_.apply(ends_, {0, padded(count_)});
  const auto knot = [&](int k, int input, int g) -> double { return ends_.at(k, input, g); };
  for (int g = 1; g < count_; ++g) {
    for (int r = 0; r < rows_; ++r) {
      const int step = r / inputs_, input = r % inputs_;
      const double position = static_cast<double>(restart_intervals_ * step) / options_.horizon;
      const int k = saturate_cast<int>(position);
      const double part = position - k;
      // A horizon of fewer than four steps has no fourth knot and needs none.
      const int next = std::min(k + 1, options_.horizon - 1);
      const double deviation = shape_.pinned() ? knot(step, input, g)
                                               : (1 - part) * knot(k, input, g) + part * knot(next, input, g);
      const double value = theta_[0][r] + std::sqrt(options_.guides.restart_variance[input]) * deviation;
      theta_[g][r] = std::clamp<double>(value, low_[r], high_[r]);
    }
  }
  round_to_float();
}

std::span<const float> Guides::best_sequence() const noexcept {
  return std::span<const float>(guides_[best_], rows_);
}

SequenceList Guides::path() const noexcept {
  const int points = point(iterations_, 0);
  return {{path_float_[0], path_float_[points]}, points};
}

std::span<const float> Guides::path_costs() const noexcept {
  return std::span<const float>(path_costs_.data(), point(iterations_, 0));
}

/// Fills the block of each guide with its gradient samples and the guide itself.
void Guides::fill_blocks(RandomKey key, int first, int last) noexcept {
  fill_normal(batch_, first * block_, (last - first) * block_, key);
  if (shape_.pinned()) shape_.apply(batch_, {first * block_, (last - first) * block_});
  const Rows rows = rows_of(batch_);
  const int biased = saturate_cast<int>((1.0 - options_.zero_mean_share) * gradient_samples_);
  for (int g = first; g < last; ++g) {
    const Range block{g * block_, block_};
    kernels::sample(rows, rows,
                    {guides_[g], deviation_.data(), low_.data(), high_.data(), block.first + biased}, block);
    const int own = block.first + gradient_samples_;
    batch_.set_sample(own, std::span<const float>(guides_[g], rows_));
  }
}

/// The surrogate gradient at a guide (equation (11)), given the costs of its block.
void Guides::estimate_gradient(int g) noexcept {
  const Rows rows = rows_of(batch_);
  const Range block{g * block_, block_};
  std::copy_n(costs_.data() + block.first, block_, totals_.data() + block.first);
  SurrogateGradient gradient{.temperature = static_cast<float>(options_.guides.gradient_temperature),
                             .subtract_minimum = options_.published.subtract_minimum,
                             .floor = options_.published.gradient_floor,
                             .centre = guides_[g],
                             .inverse_variance = inverse_.data()};
  if (options_.guides.weight == GuideWeight::importance) gradient.linear = linear_.data();
  if (options_.guides.weight == GuideWeight::proximity) {
    gradient.distance_centre = solution_.data();
    gradient.distance_weight = distance_weight_.data();
  }
  surrogate_gradient(gradient, rows, block, gradient_samples_, totals_.data(), weights_.data(), gradient_[g]);
}

/// Moves a guide one step along its gradient (equation (9)), given the costs of its block.
void Guides::step(int g, int iteration) noexcept {
  if (iteration > 0) path_costs_[point(iteration - 1, g)] = costs_[g * block_ + gradient_samples_];
  double* theta = theta_[g];
  estimate_gradient(g);
  for (int r = 0; r < rows_; ++r) {
    const double slope = gradient_[g][r];
    theta[r] += step_[r] * slope;
    if (options_.published.clamp_guides) theta[r] = std::clamp<double>(theta[r], low_[r], high_[r]);
    if (!(std::abs(theta[r]) < 1e30)) theta[r] = solution_[r];
  }
  std::copy_n(theta, rows_, guides_[g]);
  std::copy_n(theta, rows_, path_[point(iteration, g)]);
  std::copy_n(guides_[g], rows_, path_float_[point(iteration, g)]);
}

void Guides::begin_move(const float* solution, const float* nominal, int shares) noexcept {
  for (int r = 0; r < rows_; ++r) {
    const double inverse =
        weight_temperature() *
        inverse_variance<double>(weight_variance_[r], options_.published.inverse_variance_offset);
    const double u = solution[r], n = nominal[r];
    solution_[r] = solution[r];
    linear_[r] = static_cast<float>(inverse * (u - n));
    distance_weight_[r] = static_cast<float>(inverse);
  }
  std::fill(path_costs_.begin(), path_costs_.end(), infinite);
  std::fill(made_.begin(), made_.end(), 0);
  shares_ = shares;
}

void Guides::move_share(int share, const BatchEvaluator& evaluator, RandomKey key,
                        const Deadline& deadline) noexcept {
  // Guides are independent, so each share makes all iterations of its guides.
  const int first = first_guide(share), last = first_guide(share + 1);
  for (int l = 0; l < options_.guides.iterations && !deadline.passed(); ++l) {
    fill_blocks({key.seed, key.stream + l}, first, last);
    // Unless a call has a high fixed cost, guides are evaluated one at a time, so that the ranges do not
    // depend on the threads: a compiler may fuse products and sums differently at the end of a range.
    const int together = evaluator.whole_batches() ? last - first : 1;
    for (int g = first; g < last; g += together)
      evaluator.evaluate(batch_, g * block_, together * block_, costs_.data(), collided_.data());
    kernels::make_finite({first * block_, (last - first) * block_}, costs_.data());
    for (int g = first; g < last; ++g) step(g, l);
    made_[share] = l + 1;
  }
}

int Guides::end_move(const BatchEvaluator& evaluator) noexcept {
  iterations_ = *std::min_element(made_.begin(), made_.begin() + shares_);
  for (int g = 0; g < count_; ++g) ends_.set_sample(g, std::span<const float>(guides_[g], rows_));
  evaluator.evaluate(ends_, 0, count_, end_costs_.data(), end_collided_.data());
  kernels::make_finite({0, padded(count_)}, end_costs_.data());
  best_ = 0;
  for (int share = 0; share < shares_; ++share) {
    // If a share made more iterations than the others, it already has the cost of that point of the path.
    const bool ends_there = iterations_ > 0 && made_[share] == iterations_;
    for (int g = first_guide(share); g < first_guide(share + 1); ++g) {
      if (ends_there) path_costs_[point(iterations_ - 1, g)] = end_costs_[g];
      if (end_costs_[g] < end_costs_[best_]) best_ = g;
    }
  }
  best_cost_ = end_costs_[best_];
  return iterations_;
}

float Guides::cost(const BatchEvaluator& evaluator, const float* sequence) noexcept {
  ends_.set_sample(0, std::span<const float>(sequence, rows_));
  evaluator.evaluate(ends_, 0, 1, end_costs_.data(), end_collided_.data());
  kernels::make_finite({0, padded(1)}, end_costs_.data());
  return end_costs_[0];
}

/// Computes q* (equation (5)) at points of the paths: exp(-S / lambda), multiplied by the density around the
/// nominal sequence if the fit target is the optimal density. The sum over the points is 1.
void Guides::densities(double temperature, std::span<const int> points) noexcept {
  const bool with_prior = options_.published.fit_target == FitTarget::optimal_density;
  if (!with_prior) temperature = options_.published.fit_temperature;
  double largest = -std::numeric_limits<double>::infinity();
  log_error_ = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double* theta = path_[points[i]];
    double logarithm = -path_costs_[points[i]] / temperature;
    log_error_ = std::max(log_error_, std::abs(logarithm) * std::numeric_limits<float>::epsilon());
    for (int r = 0; with_prior && r < rows_; ++r) {
      const double difference = theta[r] - theta_[best_][r];
      logarithm -= 0.5 * difference * difference * distance_weight_[r] / weight_temperature();
    }
    density_[i] = logarithm;
    largest = std::max(largest, logarithm);
  }
  double sum = options_.published.normaliser_offset;
  for (std::size_t i = 0; i < points.size(); ++i) sum += density_[i] = std::exp(density_[i] - largest);
  for (std::size_t i = 0; i < points.size(); ++i) density_[i] /= sum;
}

/// The variance of the Gaussian that is fitted to row `r` of the points, with their densities.
double Guides::fit_row(int r, std::span<const int> points) noexcept {
  const int count = static_cast<int>(points.size());
  for (int i = 0; i < count; ++i) abscissa_[i] = path_[points[i]][r];
  const bool published = options_.published.fit_absolute_curvature;
  const GaussianFit fit =
      published ? fit_gaussian_as_published(abscissa_.data(), square_.data(), logarithm_.data(), count)
                : fit_gaussian(abscissa_.data(), square_.data(), logarithm_.data(), count, log_error_);
  const double variance = fitted_variance(fit, published);
  return options_.published.fit_standard_deviation ? std::sqrt(variance) : variance;
}

void Guides::fit_variance(double temperature, float* variance) noexcept {
  int count = 0;
  for (int l = 0; l < iterations_; ++l)
    for (int g = 0; g < count_; ++g)
      if (options_.published.fit_all_guides || g == best_) fit_points_[count++] = point(l, g);
  const std::span points(fit_points_.data(), count);
  const bool has_temperature = temperature > 0 || options_.published.fit_target == FitTarget::state_cost;
  const bool known =
      has_temperature && best_cost_ < infinite &&
      count >= (options_.published.fit_absolute_curvature ? 1 : 3);  // three determine a curvature
  if (known) {
    densities(temperature, points);
    fit_weights(density_.data(), count, square_.data(), logarithm_.data());
  }
  for (int r = 0; r < rows_; ++r) {
    const double fitted = known ? fit_row(r, points) : std::numeric_limits<double>::infinity();
    const double least = options_.variance_min[r % inputs_], most = options_.variance_max[r % inputs_];
    variance[r] = static_cast<float>(std::clamp(fitted, least, std::max(least, most)));
  }
}

}  // namespace slalom::detail
