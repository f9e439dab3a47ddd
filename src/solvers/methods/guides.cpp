#include "solvers/methods/guides.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/methods/gaussian_fit.hpp"
#include "solvers/methods/surrogate_gradient.hpp"

namespace slalom::detail {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

std::vector<float> spread(const PerInput& values, int horizon, int inputs) {
  std::vector<float> rows(static_cast<std::size_t>(horizon) * static_cast<std::size_t>(inputs));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r] = static_cast<float>(values[static_cast<int>(r) % inputs]);
  }
  return rows;
}

}  // namespace

Guides::Guides(const SvgMppiOptions& options, int inputs, std::span<const float> low,
               std::span<const float> high)
    : options_(options),
      inputs_(inputs),
      count_(options.guides.count),
      block_(padded(options.guides.gradient_samples + 1)),
      rows_(low.size()),
      low_(low),
      high_(high),
      theta_(at(count_)),
      shifted_(at(count_)),
      guides_(at(count_)),
      batch_(options.horizon, inputs, count_ * block_),
      ends_(options.horizon, inputs, count_),
      costs_(static_cast<std::size_t>(count_ * block_)),
      totals_(costs_.size()),
      weights_(costs_.size()),
      end_costs_(static_cast<std::size_t>(padded(count_))),
      collided_(costs_.size()),
      end_collided_(end_costs_.size()),
      gradient_(at(count_)),
      deviation_(spread(options.guides.gradient_variance, options.horizon, inputs)),
      inverse_(deviation_),
      step_(spread(options.guides.step, options.horizon, inputs)),
      weight_variance_(spread(options.guides.variance, options.horizon, inputs)),
      linear_(rows_),
      distance_weight_(rows_),
      solution_(rows_),
      path_(path_at(options.guides.iterations, 0) * rows_),
      path_float_(path_.size()),
      path_costs_(path_at(options.guides.iterations, 0)),
      made_(static_cast<std::size_t>(count_)),
      points_(path_costs_.size()),
      density_(path_costs_.size()),
      square_(path_costs_.size()),
      logarithm_(path_costs_.size()),
      abscissa_(path_costs_.size()) {
  for (std::size_t r = 0; r < rows_; ++r) {
    const double variance = static_cast<double>(deviation_[r]);
    inverse_[r] = static_cast<float>(inverse_variance(variance, options.published.inverse_variance_offset));
    deviation_[r] = static_cast<float>(std::sqrt(variance));
  }
}

void Guides::restart(RandomKey key) noexcept {
  fill_normal(ends_, 0, count_, key);
  for (int g = 0; g < count_; ++g) {
    for (std::size_t r = 0; r < rows_; ++r) {
      const float z =
          ends_.row(0, 0)[r * static_cast<std::size_t>(ends_.stride()) + static_cast<std::size_t>(g)];
      theta_[at(g) + r] =
          static_cast<double>(std::clamp(std::sqrt(weight_variance_[r]) * z, low_[r], high_[r]));
      guides_[at(g) + r] = static_cast<float>(theta_[at(g) + r]);
    }
  }
  iterations_ = 0;
  best_ = 0;
}

void Guides::shift(double steps) noexcept {
  for (int g = 0; g < count_; ++g) {
    shift_sequence(&theta_[at(g)], options_.horizon, inputs_, steps, &shifted_[at(g)]);
  }
  theta_.swap(shifted_);
  for (std::size_t i = 0; i < theta_.size(); ++i) guides_[i] = static_cast<float>(theta_[i]);
}

/// Smooth deviations: straight lines between normal values at knots a third of the horizon apart.
void Guides::restart_others(RandomKey key) noexcept {
  if (!options_.guides.restart || count_ == 1) return;
  std::copy_n(&theta_[at(best_)], rows_, shifted_.begin());
  std::copy_n(shifted_.begin(), rows_, &theta_[at(0)]);
  best_ = 0;
  fill_normal(ends_, 0, padded(count_), key);
  const auto knot = [&](int k, int input, int g) { return static_cast<double>(ends_.row(k, input)[g]); };
  for (int g = 1; g < count_; ++g) {
    for (std::size_t r = 0; r < rows_; ++r) {
      const int step = static_cast<int>(r) / inputs_, input = static_cast<int>(r) % inputs_;
      const double place = restart_knots_ * static_cast<double>(step) / options_.horizon;
      const int k = static_cast<int>(place);
      const double part = place - k;
      // A horizon of less than four steps has no fourth knot, and needs none.
      const int next = std::min(k + 1, options_.horizon - 1);
      const double deviation = (1 - part) * knot(k, input, g) + part * knot(next, input, g);
      theta_[at(g) + r] =
          std::clamp(theta_[at(0) + r] + std::sqrt(options_.guides.restart_variance[input]) * deviation,
                     static_cast<double>(low_[r]), static_cast<double>(high_[r]));
    }
  }
  for (std::size_t i = 0; i < theta_.size(); ++i) guides_[i] = static_cast<float>(theta_[i]);
}

std::span<const float> Guides::best_sequence() const noexcept {
  return {&guides_[at(best_)], rows_};
}

SequenceList Guides::path() const noexcept {
  const std::size_t points = path_at(iterations_, 0);
  return {{path_float_.data(), points * rows_}, static_cast<int>(points)};
}

std::span<const float> Guides::path_costs() const noexcept {
  return {path_costs_.data(), path_at(iterations_, 0)};
}

/// Fills the blocks of the guides with their gradient samples and themselves.
void Guides::place(RandomKey key, int first, int last) noexcept {
  fill_normal(batch_, first * block_, (last - first) * block_, key);
  const Rows<float> rows{batch_.row(0, 0), batch_.stride(), static_cast<int>(rows_)};
  const int biased = static_cast<int>((1.0 - options_.zero_mean_share) *
                                      static_cast<double>(options_.guides.gradient_samples));
  for (int g = first; g < last; ++g) {
    const Range block{g * block_, block_};
    kernels().sample(rows, rows,
                     {&guides_[at(g)], deviation_.data(), low_.data(), high_.data(), block.first + biased},
                     block);
    const int own = block.first + options_.guides.gradient_samples;
    for (int r = 0; r < rows.rows; ++r) {
      rows.row(r)[own] = guides_[at(g) + static_cast<std::size_t>(r)];
    }
  }
}

/// One step of a guide along its gradient, from the costs of its block.
void Guides::step(int g, int iteration) noexcept {
  const Rows<float> rows{batch_.row(0, 0), batch_.stride(), static_cast<int>(rows_)};
  const Range block{g * block_, block_};
  const auto own = static_cast<std::size_t>(block.first + options_.guides.gradient_samples);
  if (iteration > 0) path_costs_[path_at(iteration - 1, g)] = costs_[own];
  std::copy_n(costs_.data() + block.first, block_, totals_.data() + block.first);
  SurrogateGradient<float> gradient;
  gradient.temperature = static_cast<float>(options_.guides.gradient_temperature);
  gradient.subtract_minimum = options_.published.subtract_minimum;
  gradient.floor = options_.published.gradient_floor;
  gradient.centre = &guides_[at(g)];
  gradient.inverse_variance = inverse_.data();
  if (options_.guides.weight == GuideWeight::importance) gradient.linear = linear_.data();
  if (options_.guides.weight == GuideWeight::proximity) {
    gradient.distance_centre = solution_.data();
    gradient.distance_weight = distance_weight_.data();
  }
  surrogate_gradient(gradient, rows, block, options_.guides.gradient_samples, totals_.data(), weights_.data(),
                     &gradient_[at(g)]);
  double* theta = &theta_[at(g)];
  for (std::size_t r = 0; r < rows_; ++r) {
    theta[r] += static_cast<double>(step_[r]) * static_cast<double>(gradient_[at(g) + r]);
    if (options_.published.clamp_guides) {
      theta[r] = std::clamp(theta[r], static_cast<double>(low_[r]), static_cast<double>(high_[r]));
    }
    if (!(std::abs(theta[r]) < 1e30)) theta[r] = static_cast<double>(solution_[r]);
    guides_[at(g) + r] = static_cast<float>(theta[r]);
    path_[path_at(iteration, g) * rows_ + r] = theta[r];
    path_float_[path_at(iteration, g) * rows_ + r] = guides_[at(g) + r];
  }
}

void Guides::move_some(const BatchEvaluator& evaluator, RandomKey key, int first, int last, int iterations,
                       const Deadline& deadline, int& made) noexcept {
  for (int l = 0; l < iterations && !deadline.passed(); ++l) {
    place({key.seed, key.stream + static_cast<std::uint64_t>(l)}, first, last);
    evaluator.evaluate(batch_, first * block_, (last - first) * block_, costs_.data(), collided_.data());
    kernels().make_finite({first * block_, (last - first) * block_}, costs_.data());
    for (int g = first; g < last; ++g) step(g, l);
    made = l + 1;
  }
}

int Guides::move(const BatchEvaluator& evaluator, RandomKey key, const float* solution, const float* nominal,
                 ThreadPool& pool, const Deadline& deadline) noexcept {
  for (std::size_t r = 0; r < rows_; ++r) {
    const double inverse =
        options_.guides.gradient_temperature * inverse_variance(static_cast<double>(weight_variance_[r]),
                                                                options_.published.inverse_variance_offset);
    solution_[r] = solution[r];
    linear_[r] =
        static_cast<float>(inverse * (static_cast<double>(solution[r]) - static_cast<double>(nominal[r])));
    distance_weight_[r] = static_cast<float>(inverse);
  }
  std::fill(path_costs_.begin(), path_costs_.end(), infinite);
  std::fill(made_.begin(), made_.end(), 0);
  // Guides do not depend on each other, so each thread moves its share all the way.
  const int shares = std::min(pool.threads(), count_);
  pool.run(shares, [&](int share) {
    move_some(evaluator, key, count_ * share / shares, count_ * (share + 1) / shares,
              options_.guides.iterations, deadline, made_[static_cast<std::size_t>(share)]);
  });
  iterations_ = *std::min_element(made_.begin(), made_.begin() + shares);
  evaluate_ends(evaluator, iterations_);
  return iterations_;
}

/// Costs of the guides where they ended, and which of them is the best.
void Guides::evaluate_ends(const BatchEvaluator& evaluator, int iterations) noexcept {
  for (int g = 0; g < count_; ++g)
    for (std::size_t r = 0; r < rows_; ++r)
      ends_.row(0, 0)[r * static_cast<std::size_t>(ends_.stride()) + static_cast<std::size_t>(g)] =
          guides_[at(g) + r];
  evaluator.evaluate(ends_, 0, count_, end_costs_.data(), end_collided_.data());
  kernels().make_finite({0, padded(count_)}, end_costs_.data());
  best_ = 0;
  for (int g = 0; g < count_; ++g) {
    const auto i = static_cast<std::size_t>(g);
    if (iterations > 0) path_costs_[path_at(iterations - 1, g)] = end_costs_[i];
    if (end_costs_[i] < end_costs_[static_cast<std::size_t>(best_)]) best_ = g;
  }
  best_cost_ = end_costs_[static_cast<std::size_t>(best_)];
  best_collides_ = end_collided_[static_cast<std::size_t>(best_)] != 0;
}

/// q* at the points of the paths: exp(-S / lambda), times the density round the nominal if asked for,
/// normalised over the points.
void Guides::densities(std::span<const int> points) noexcept {
  const bool with_prior = options_.published.fit_target == FitTarget::optimal_density;
  const double temperature = with_prior ? options_.temperature : options_.published.fit_temperature;
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto point = static_cast<std::size_t>(points[i]);
    double logarithm = -static_cast<double>(path_costs_[point]) / temperature;
    if (with_prior) {
      for (std::size_t r = 0; r < rows_; ++r) {
        const double difference = path_[point * rows_ + r] - theta_[at(best_) + r];
        logarithm -= 0.5 * difference * difference * static_cast<double>(distance_weight_[r]) /
                     options_.guides.gradient_temperature;
      }
    }
    density_[i] = logarithm;
    largest = std::max(largest, logarithm);
  }
  double sum = options_.published.normaliser_offset;
  for (std::size_t i = 0; i < points.size(); ++i) sum += density_[i] = std::exp(density_[i] - largest);
  for (std::size_t i = 0; i < points.size(); ++i) density_[i] /= sum;
}

void Guides::fit_variance(float* variance) noexcept {
  std::size_t count = 0;
  for (int l = 0; l < iterations_; ++l)
    for (int g = 0; g < count_; ++g)
      if (options_.published.fit_all_guides || g == best_) points_[count++] = static_cast<int>(path_at(l, g));
  const std::span<const int> points(points_.data(), count);
  const bool known = best_cost_ < infinite && count > 0;
  if (known) {
    densities(points);
    fit_weights(density_.data(), static_cast<int>(count), square_.data(), logarithm_.data());
  }
  for (std::size_t r = 0; r < rows_; ++r) {
    const int input = static_cast<int>(r) % inputs_;
    const double least = options_.variance_min[input], most = options_.variance_max[input];
    double fitted = std::numeric_limits<double>::infinity();
    if (known) {
      for (std::size_t i = 0; i < count; ++i) {
        abscissa_[i] = path_[static_cast<std::size_t>(points[i]) * rows_ + r];
      }
      const GaussianFit fit =
          fit_gaussian(abscissa_.data(), square_.data(), logarithm_.data(), static_cast<int>(count));
      fitted = fitted_variance(fit, options_.published.fit_absolute_curvature);
      if (options_.published.fit_standard_deviation) fitted = std::sqrt(fitted);
    }
    variance[r] = static_cast<float>(std::clamp(fitted, least, std::max(least, most)));
  }
}

}  // namespace slalom::detail
