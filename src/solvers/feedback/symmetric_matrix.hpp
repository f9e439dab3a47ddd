#pragma once

#include <cmath>
#include <cstddef>
#include <span>

/// Small dense symmetric matrices, row by row.
namespace slalom::detail {

/// A view of a square matrix.
struct SquareMatrix {
  std::span<double> values;  ///< [size][size]
  int size;

  double& operator()(int row, int column) const {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                  static_cast<std::size_t>(column)];
  }
};

/// Replaces the lower triangle by the Cholesky factor L, where the matrix is L L^T. Returns false if it is
/// not positive definite.
inline bool factorise(SquareMatrix a) noexcept {
  for (int j = 0; j < a.size; ++j) {
    double pivot = a(j, j);
    for (int k = 0; k < j; ++k) pivot -= a(j, k) * a(j, k);
    if (!(pivot > 0)) return false;
    a(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < a.size; ++i) {
      double sum = a(i, j);
      for (int k = 0; k < j; ++k) sum -= a(i, k) * a(j, k);
      a(i, j) = sum / a(j, j);
    }
  }
  return true;
}

/// Solves L L^T x = b in place; entry i of the vector is b[i * stride].
inline void solve_factorised(SquareMatrix l, double* b, std::ptrdiff_t stride) noexcept {
  for (int i = 0; i < l.size; ++i) {
    for (int k = 0; k < i; ++k) b[i * stride] -= l(i, k) * b[k * stride];
    b[i * stride] /= l(i, i);
  }
  for (int i = l.size - 1; i >= 0; --i) {
    for (int k = i + 1; k < l.size; ++k) b[i * stride] -= l(k, i) * b[k * stride];
    b[i * stride] /= l(i, i);
  }
}

/// Makes `a` diagonal by Jacobi rotations (Golub and Van Loan, Matrix Computations, 4th ed., section 8.5), so
/// that it was V a V^T with the orthogonal `v`.
inline void diagonalise(SquareMatrix a, SquareMatrix v) noexcept {
  for (int i = 0; i < a.size; ++i)
    for (int j = 0; j < a.size; ++j) v(i, j) = i == j;
  for (int sweep = 0; sweep < 30; ++sweep) {
    double off = 0, diagonal = 0;
    for (int i = 0; i < a.size; ++i) {
      diagonal += a(i, i) * a(i, i);
      for (int j = 0; j < i; ++j) off += a(i, j) * a(i, j);
    }
    if (!(off > 1e-30 * diagonal)) return;
    for (int p = 0; p < a.size; ++p) {
      for (int q = p + 1; q < a.size; ++q) {
        if (a(p, q) == 0) continue;
        const double tau = (a(q, q) - a(p, p)) / (2 * a(p, q));
        const double t = (tau >= 0 ? 1.0 : -1.0) / (std::abs(tau) + std::hypot(1, tau));
        const double c = 1 / std::hypot(1, t), s = t * c;
        for (int k = 0; k < a.size; ++k) {
          const double kp = a(k, p), kq = a(k, q);
          a(k, p) = c * kp - s * kq;
          a(k, q) = s * kp + c * kq;
        }
        for (int k = 0; k < a.size; ++k) {
          const double pk = a(p, k), qk = a(q, k), vp = v(k, p), vq = v(k, q);
          a(p, k) = c * pk - s * qk;
          a(q, k) = s * pk + c * qk;
          v(k, p) = c * vp - s * vq;
          v(k, q) = s * vp + c * vq;
        }
      }
    }
  }
}

}  // namespace slalom::detail
