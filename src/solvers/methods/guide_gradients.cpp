// Guides that follow the exact gradient of the cost.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "solvers/methods/guides.hpp"

namespace slalom::detail {

void Guides::connect(const BatchEvaluator& evaluator) {
  if (options_.guides.gradient != GuideGradient::exact) return;
  const CostGradient* const gradient = evaluator.gradient();
  if (!gradient)
    throw std::invalid_argument(
        "guide_gradient: exact needs a problem with derivatives (in C++ a GradientEvaluator, in Python a "
        "built-in "
        "problem) and without limits on the rates of inputs");
  workspace_.resize(static_cast<std::size_t>(count_) * gradient->workspace(options_.horizon));
  taken_ = Matrix<double>(count_, rows_);
}

int Guides::gradient_kinks() const noexcept {
  return std::accumulate(kinks_.begin(), kinks_.end(), 0);
}

/// Returns the exact gradients of this evaluator, if guides follow them and have their working memory; else
/// null.
const CostGradient* Guides::exact_gradient(const BatchEvaluator& evaluator) const noexcept {
  if (options_.guides.gradient != GuideGradient::exact || workspace_.empty()) return nullptr;
  const CostGradient* const gradient = evaluator.gradient();
  const bool fits = gradient && workspace_.size() >=
                                    static_cast<std::size_t>(count_) * gradient->workspace(options_.horizon);
  return fits ? gradient : nullptr;
}

/// Computes the gradient at a guide if the last step has lowered its cost. Otherwise moves the guide back to
/// its best point and keeps the gradient of that point, for half the step. Returns the part of the step to
/// make.
double Guides::take_gradient(const CostGradient& cost, int g, int iteration) noexcept {
  const int own = g * block_ + gradient_samples_;
  if (iteration > 0 && !(costs_[own] < taken_costs_[g])) {
    std::copy_n(taken_[g], rows_, theta_[g]);
    return part_[g] *= 0.5;
  }
  std::copy_n(theta_[g], rows_, taken_[g]);
  taken_costs_[g] = costs_[own];
  differentiate(cost, g);
  return part_[g] = iteration > 0 ? std::min(2 * part_[g], 1.0) : 1;
}

/// Computes the gradient of -S / lambda at a guide. The root mean square of its entries, in units of
/// Sigma_g^-1/2, is limited to 1: that of the surrogate gradient if a single sample decides it.
void Guides::differentiate(const CostGradient& cost, int g) noexcept {
  const std::size_t size = workspace_.size() / static_cast<std::size_t>(count_);
  const std::span<double> workspace = std::span(workspace_).subspan(static_cast<std::size_t>(g) * size, size);
  float* const gradient = gradient_[g];
  const GradientQuality quality =
      cost.differentiate(std::span<const float>(guides_[g], rows_), workspace, std::span(gradient, rows_));
  if (quality != GradientQuality::exact) ++kinks_[g];
  if (quality == GradientQuality::not_finite) {
    std::fill_n(gradient, rows_, 0.0f);
    return;
  }
  double squares = 0;
  for (int r = 0; r < rows_; ++r) {
    const double slope = deviation_[r] * gradient[r] / options_.guides.gradient_temperature;
    squares += slope * slope;
  }
  const double limit = squares > rows_ ? std::sqrt(rows_ / squares) : 1;
  for (int r = 0; r < rows_; ++r) {
    const double slope = -gradient[r] / options_.guides.gradient_temperature;
    gradient[r] = deviation_[r] > 0 ? static_cast<float>(limit * slope) : 0.0f;
  }
}

/// Moves a guide back to its best point if the last step has raised its cost.
void Guides::return_if_worse(int g) noexcept {
  if (!(taken_costs_[g] < end_costs_[g])) return;
  std::copy_n(taken_[g], rows_, theta_[g]);
  std::copy_n(taken_[g], rows_, guides_[g]);
  end_costs_[g] = taken_costs_[g];
}

}  // namespace slalom::detail
