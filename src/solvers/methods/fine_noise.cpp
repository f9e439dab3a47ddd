#include "solvers/methods/fine_noise.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::detail {

namespace {

// The numbers were chosen on the seeds from 76000 of the problem suite.
constexpr double half_spread = 0.7;          ///< greatest x
constexpr double growth = 1.3, decay = 0.7;  ///< factors of a
constexpr double least_scale = 1e-4;         ///< lower limit of a
constexpr double shape_rate = 0.1;           ///< weight of a batch in s

}  // namespace

FineNoise::FineNoise(const std::vector<float>& first_variance)
    : first_(first_variance), shape_(first_.size(), 1.0f), deviation_(first_.size()) {
  for (float& value : first_) value = std::sqrt(value);
}

void FineNoise::reset() noexcept {
  scale_ = 1;
  std::fill(shape_.begin(), shape_.end(), 1.0f);
}

const std::vector<float>& FineNoise::deviation() noexcept {
  for (std::size_t r = 0; r < first_.size(); ++r)
    deviation_[r] = static_cast<float>(std::min(scale_ * static_cast<double>(shape_[r]), 1.0)) * first_[r];
  return deviation_;
}

/// Multiples of the golden ratio are spread evenly over [0, 1), whatever their number.
float FineNoise::spread(std::int64_t index) noexcept {
  constexpr double golden = 0.6180339887498949;
  const double part = std::fmod(static_cast<double>(index) * golden, 1.0);
  return static_cast<float>(std::exp(half_spread * (2 * part - 1)));
}

void FineNoise::learn_scale(bool improved) noexcept {
  scale_ = std::clamp(scale_ * (improved ? growth : decay), least_scale, 1.0);
}

void FineNoise::learn_shape(const std::vector<double>& squares) noexcept {
  double logarithms = 0;
  for (std::size_t r = 0; r < shape_.size(); ++r) {
    const double drawn = deviation_[r];
    const double found = drawn > 0 ? std::clamp(std::sqrt(squares[r]) / drawn, 0.1, 10.0) : 1;
    shape_[r] = static_cast<float>(std::clamp(shape_[r] * std::pow(found, shape_rate), 1e-6, 1e6));
    logarithms += std::log(static_cast<double>(shape_[r]));
  }
  const double mean = std::exp(logarithms / static_cast<double>(shape_.size()));
  for (float& entry : shape_) entry = static_cast<float>(entry / mean);
}

}  // namespace slalom::detail
