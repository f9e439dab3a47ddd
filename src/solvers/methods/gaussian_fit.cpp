#include "solvers/methods/gaussian_fit.hpp"

#include <Eigen/QR>

namespace slalom::detail {

/// The paper's program solves the normal equations by the same decomposition: a column counts as dependent,
/// with coefficient 0, if only rounding error of it is left.
GaussianFit fit_gaussian_as_published(const double* x, const double* square, const double* logarithm,
                                      int count) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < 3; ++i) {
      double power = square[k];
      for (int p = 0; p < i; ++p) power *= x[k];
      b[i] += power * logarithm[k];
      for (int j = 0; j < 3; ++j) {
        a(i, j) += power;
        power *= x[k];
      }
    }
  }
  const double curvature = a.colPivHouseholderQr().solve(b)[2];
  return {curvature, curvature != 0};
}

}  // namespace slalom::detail
