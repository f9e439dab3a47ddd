#include "slalom/solvers/prediction_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slalom {

PredictionErrors::PredictionErrors(int scalars)
    : errors_(static_cast<std::size_t>(kept * scalars)), limits_(static_cast<std::size_t>(scalars)) {}

void PredictionErrors::add(std::span<const double> state, std::span<const double> predicted) noexcept {
  const std::size_t scalars = limits_.size();
  double* const errors = &errors_[static_cast<std::size_t>(added_++ % kept) * scalars];
  for (std::size_t i = 0; i < scalars; ++i) {
    const double error = state[i] - predicted[i];
    const double resolution = std::numeric_limits<float>::epsilon() * std::abs(state[i]);
    errors[i] = std::abs(error) > resolution && std::isfinite(error) ? error : 0;
    double largest = 0;
    limits_[i] = 0;
    for (std::size_t at = i; at < errors_.size(); at += scalars) {
      const double size = std::abs(errors_[at]);
      limits_[i] = std::max(limits_[i], std::min(size, largest));
      largest = std::max(largest, size);
    }
  }
}

void PredictionErrors::clear() noexcept {
  std::fill(errors_.begin(), errors_.end(), 0.0);
  std::fill(limits_.begin(), limits_.end(), 0.0);
  added_ = 0;
}

int PredictionErrors::count() const noexcept {
  const bool exact = std::all_of(limits_.begin(), limits_.end(), [](double limit) { return limit == 0; });
  return exact ? 0 : 2 * static_cast<int>(std::min<std::int64_t>(added_, kept));
}

void PredictionErrors::move(std::span<const double> state, int index,
                            std::span<double> moved) const noexcept {
  const double* const errors = &errors_[static_cast<std::size_t>(index / 2) * limits_.size()];
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    const double error = std::clamp(errors[i], -limits_[i], limits_[i]);
    moved[i] = state[i] + (index % 2 == 0 ? error : -error);
  }
}

}  // namespace slalom
