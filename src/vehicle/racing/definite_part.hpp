#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace slalom::vehicle::detail {

/// Replaces the negative eigenvalues of a symmetric N x N matrix, given by its lower triangle row by row, by
/// 0. Eigenvalues by Jacobi's cyclic rotations (Golub & Van Loan, "Matrix Computations", 2013, Sec. 8.5).
template <int N>
void make_positive(std::array<double, N*(N + 1) / 2>& triangle) {
  double a[N][N], v[N][N];
  for (int i = 0, k = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j, ++k) {
      a[i][j] = a[j][i] = triangle[static_cast<std::size_t>(k)];
      v[i][j] = v[j][i] = i == j ? 1 : 0;
    }
  for (int sweep = 0; sweep < 12; ++sweep) {
    double off = 0, all = 0;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) {
        all += a[i][j] * a[i][j];
        if (i != j) off += a[i][j] * a[i][j];
      }
    if (off <= 1e-20 * all) break;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < N; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < N; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
        }
        for (int k = 0; k < N; ++k) {
          const double x = v[k][p], y = v[k][q];
          v[k][p] = c * x - s * y;
          v[k][q] = s * x + c * y;
        }
      }
  }
  for (int i = 0, k = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j, ++k) {
      double sum = 0;
      for (int m = 0; m < N; ++m) sum += v[i][m] * std::max(a[m][m], 0.0) * v[j][m];
      triangle[static_cast<std::size_t>(k)] = sum;
    }
}

}  // namespace slalom::vehicle::detail
