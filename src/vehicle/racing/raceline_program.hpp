#pragma once

#include <Eigen/SparseCore>

#include "slalom/vehicle/racing/corridor.hpp"
#include "slalom/vehicle/racing/racing_car.hpp"

namespace slalom::vehicle::detail {

/// The variables of the minimum-time program, a point each.
struct RacelineState {
  std::vector<double> offset;  ///< m, to the left of the centre line
  std::vector<double> square;  ///< squared speed, as a share of the squared top speed
};

/// The minimum-time program of minimum_time_raceline() with a logarithmic barrier for its constraints.
class RacelineProgram {
 public:
  /// Uses both as long as it lives.
  RacelineProgram(const Corridor& corridor, const RacingCar& car);

  int points() const { return count_; }
  /// The number of constraints.
  int constraints() const { return 9 * count_; }
  double lower(int i) const { return lower_[i]; }  ///< m, bound of an offset
  double upper(int i) const { return upper_[i]; }  ///< m, bound of an offset

  /// 1/m; at first the car's.
  double curvature_limit() const { return curvature_limit_; }
  void set_curvature_limit(double limit) { curvature_limit_ = limit; }

  /// The points of a line, m.
  std::vector<maps::Point> line(const RacelineState& state) const;

  /// s, the time along the line.
  double time(const RacelineState& state) const;

  /// The time plus `weight` times the barrier, which is infinite where a constraint is broken.
  double value(const RacelineState& state, double weight) const;

  /// The gradient of value() and a positive semi-definite matrix of second derivatives: that of each segment
  /// without its negative eigenvalues. The sum then needs no shift towards the unit matrix, with which the
  /// steps would be short. The variables of point i are 2 i, its offset, and 2 i + 1, its squared speed.
  void derivatives(const RacelineState& state, double weight, Eigen::VectorXd& gradient,
                   Eigen::SparseMatrix<double>& hessian) const;

 private:
  /// Returns the value of segment i, from point i to the next: its time plus `weight` times its barrier.
  template <class T>
  T segment(int i, const T (&offset)[4], const T (&square)[2], double weight) const;

  /// The points i-1 .. i+2; beyond the ends of an open line the end point, which then does not count.
  void segment_points(int i, int (&nodes)[4]) const;

  int segments() const { return closed_ ? count_ : count_ - 1; }

  const Corridor& corridor_;
  const RacingCar& car_;
  int count_;
  bool closed_;
  double curvature_limit_, top_square_;
  std::vector<double> lower_, upper_;
};

}  // namespace slalom::vehicle::detail
