#pragma once

#include <algorithm>

namespace slalom::tracking {

/// A normal distribution with the steps of a Kalman filter.
template <int Size>
struct Gaussian {
  double mean[Size] = {};
  double covariance[Size][Size] = {};

  /// covariance = F covariance F^T
  void propagate(const double (&transition)[Size][Size]) noexcept {
    double left[Size][Size] = {};
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j)
        for (int k = 0; k < Size; ++k) left[i][j] += transition[i][k] * covariance[k][j];
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) {
        double sum = 0;
        for (int k = 0; k < Size; ++k) sum += left[i][k] * transition[j][k];
        covariance[i][j] = sum;
      }
  }

  /// Adds noise of the given variance along a direction: covariance += variance g g^T.
  void add_noise(const double (&direction)[Size], double variance) noexcept {
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) covariance[i][j] += variance * direction[i] * direction[j];
  }

  /// Variance of h^T x.
  double variance_along(const double (&row)[Size]) const noexcept {
    double sum = 0;
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) sum += row[i] * covariance[i][j] * row[j];
    return sum;
  }

  /// Corrects with a scalar measurement of h^T x: `innovation` is measured minus predicted.
  void correct(const double (&row)[Size], double innovation, double variance) noexcept {
    double gain[Size] = {};
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) gain[i] += covariance[i][j] * row[j];
    double total = variance;
    for (int i = 0; i < Size; ++i) total += row[i] * gain[i];
    for (int i = 0; i < Size; ++i) mean[i] += gain[i] * innovation / total;
    // P - (P h)(P h)^T / s is symmetric whatever the rounding.
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) covariance[i][j] -= gain[i] * gain[j] / total;
    for (int i = 0; i < Size; ++i) covariance[i][i] = std::max(covariance[i][i], 1e-9);
  }
};

}  // namespace slalom::tracking
