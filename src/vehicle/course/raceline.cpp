#include "slalom/vehicle/course/raceline.hpp"

#include "slalom/core/option_access.hpp"
#include "vehicle/course/curve.hpp"

namespace slalom::vehicle {
namespace {

using namespace detail;  // curves, and the operators of points

constexpr double relaxation = 1.6;  // 1 is Gauss-Seidel, below 2 converges
constexpr double tolerance = 1e-6;  // m per sweep
constexpr int max_sweeps = 20000;
constexpr std::size_t fewest_points = 24;  // points of the coarsest level

/// One level of the quadratic program. Updates the second differences when an offset changes.
class Level {
 public:
  Level(const Curve& points, const Curve& normals, std::vector<double>& offsets)
      : normals_(normals), offsets_(offsets), second_(points.size()) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
      second_[i] = points[before] - 2 * points[i] + points[after] + offsets[before] * normals[before] -
                   (2 * offsets[i]) * normals[i] + offsets[after] * normals[after];
    }
  }

  /// Moves every offset once; returns the largest move, m.
  double sweep(double bound) {
    const std::size_t n = offsets_.size();
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t before = i == 0 ? n - 1 : i - 1, after = i + 1 == n ? 0 : i + 1;
      const double slope = dot(normals_[i], second_[before] - 2 * second_[i] + second_[after]);
      const double target = std::clamp(offsets_[i] - relaxation * slope / 6, -bound, bound);
      const double move = target - offsets_[i];
      const maps::Point shift = move * normals_[i];
      second_[before] = second_[before] + shift;
      second_[i] = second_[i] - 2 * shift;
      second_[after] = second_[after] + shift;
      offsets_[i] = target;
      largest = std::max(largest, std::abs(move));
    }
    return largest;
  }

 private:
  const Curve& normals_;
  std::vector<double>& offsets_;
  std::vector<maps::Point> second_;  ///< second differences of the line, m
};

std::vector<double> solve(const Curve& points, const Curve& normals, double bound) {
  const std::size_t n = points.size();
  std::vector<double> offsets(n, 0.0);
  if (n / 2 >= fewest_points) {
    Curve coarse_points, coarse_normals;
    for (std::size_t i = 0; i + (n % 2) < n; i += 2) {
      coarse_points.push_back(points[i]);
      coarse_normals.push_back(normals[i]);
    }
    const auto coarse = solve(coarse_points, coarse_normals, bound);
    for (std::size_t i = 0; i < n; ++i) {
      const double left = coarse[std::min(i / 2, coarse.size() - 1)],
                   right = coarse[(i + 1) / 2 % coarse.size()];
      offsets[i] = 0.5 * (left + right);
    }
  }
  Level level(points, normals, offsets);
  for (int k = 0; k < max_sweeps && level.sweep(bound) > tolerance; ++k) {
  }
  return offsets;
}

}  // namespace

std::vector<double> minimum_curvature_offsets(const std::vector<maps::Point>& centre_line, double bound) {
  if (centre_line.size() < 8)
    throw std::invalid_argument("centre_line: " + std::to_string(centre_line.size()) +
                                " points; at least 8 are needed");
  if (!(bound >= 0)) throw std::invalid_argument("bound: " + to_text(bound) + " must be at least 0 m");
  return solve(centre_line, normals(centre_line), bound);
}

}  // namespace slalom::vehicle
