#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "solvers/kernels/kernels.hpp"

/// Stein variational gradient descent (Liu and Wang, NeurIPS 2016): particles x_i move along
///
///     phi(x_i) = 1/n sum_j [ k(x_j, x_i) g_j + grad_{x_j} k(x_j, x_i) ],   k(a, b) = exp(-|a - b|^2 / h)
///     grad_{x_j} k = -2/h k (x_j - x_i)
///
/// where g_j is the gradient of the log posterior at x_j. `kernels::stein_directions` computes phi; this file
/// computes the bandwidth h.
namespace slalom::detail {

/// The smallest bandwidth.
inline constexpr float min_bandwidth = 1e-5f;

/// The bandwidth h = median / log n, at least 1e-5. `particles` is n. The median is element count/2 of the
/// sorted values; `values` is reordered.
inline float bandwidth(float* values, int count, int particles) noexcept {
  float* middle = values + count / 2;
  std::nth_element(values, middle, values + count);
  const float h = *middle / std::log(static_cast<float>(particles));
  return std::max(min_bandwidth, h);
}

/// Squared distances between all pairs of at most 64 evenly selected particles. Their median is an estimate
/// of the median over all pairs, at a fraction of the cost. Returns their number, at most 2016.
inline int pair_distances(const Rows& x, int count, float* values) noexcept {
  const std::ptrdiff_t all = count;  // a product of indices may exceed the range of an `int`
  const int picked = std::min(count, 64);
  int pairs = 0;
  for (int a = 0; a < picked; ++a) {
    for (int b = a + 1; b < picked; ++b) {
      const std::ptrdiff_t i = a * all / picked, j = b * all / picked;
      float distance = 0;
      for (int r = 0; r < x.rows; ++r) {
        const float d = x.row(r)[i] - x.row(r)[j];
        distance += d * d;
      }
      values[pairs++] = distance;
    }
  }
  return pairs;
}

}  // namespace slalom::detail
