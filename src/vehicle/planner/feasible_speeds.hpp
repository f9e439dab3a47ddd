#pragma once

#include <span>
#include <vector>

#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle::detail {

/// The limits of a car on a ground.
struct DrivingLimits {
  double grip = 9;           ///< m/s^2, of the tyres in any direction
  double acceleration = 9;   ///< m/s^2, of the motor below `switch_speed`
  double braking = 9;        ///< m/s^2
  double braking_share = 1;  ///< share of the grip that turning leaves and braking may use
  double delay = 0;          ///< s; the car follows the speeds this late
  double lead = 0;           ///< s from the look-up of a speed until the car has it
  double switch_speed = 7;   ///< m/s, above it the motor's power is the limit
  double top_speed = 1e3;    ///< m/s
};

/// The limits of a model with tyres that slip, on ground of this friction.
DrivingLimits driving_limits(const VehicleTraits& traits, double friction);

/// Computes the highest speeds that a car can drive along a path, no higher than the path's own:
///
///     v^2 |k| <= grip,   -braking <= dv/dt <= acceleration,   (v^2 k)^2 + (b dv/dt)^2 <= grip^2
///
/// with b = 1 / braking_share for dv/dt < 0, else 1, by a pass forward and one backward (Heilmeier et al.
/// 2020, Sec. 4; see feasible_speeds). Each is low enough for the rest of the path. With `lead`, a point has
/// the speed of the place that the car reaches after this time; where speeds rise, that is more than the car
/// can drive at the point itself. The speeds can be updated while driving, when the friction changes.
class FeasibleSpeeds {
 public:
  /// `grip_shares` are shares of the grip in the limits, one for each part of the path; the parts have equal
  /// lengths. Without any, all of the grip is used.
  explicit FeasibleSpeeds(std::span<const maps::ReferencePoint> path,
                          std::span<const double> grip_shares = {});

  /// Computes the speeds. Allocates nothing.
  void update(const DrivingLimits& limits) noexcept;

  /// The distance of a point along the path, m.
  double arc(int point) const noexcept { return arc_[point]; }
  /// The length of a closed path, m; 0 if it is open.
  double length() const noexcept { return gap_.back() > 0 ? arc_.back() + gap_.back() : 0; }

  /// The curvature of the path at each point, 1/m, positive to the left.
  std::span<const double> curvatures() const noexcept { return curvature_; }
  /// The speed at each point, m/s, looked up ahead with `lead`. Before the first update, the path's own.
  std::span<const double> speeds() const noexcept { return speed_; }

 private:
  double grip_left(std::size_t i, double full_grip) const noexcept;
  void limit(std::size_t to, std::size_t from, double gap, double change) noexcept;
  void anticipate(double delay) noexcept;
  void look_ahead(double lead) noexcept;

  std::vector<double> own_, speed_;  ///< m/s
  std::vector<double> profile_;      ///< m/s, speeds before `look_ahead` replaces them
  std::vector<double> arc_;          ///< m
  std::vector<double> curvature_;    ///< 1/m, positive to the left
  std::vector<double> share_;        ///< share of the grip at each point
  std::vector<double> gap_;          ///< m, from each point to the next; 0 at the end of an open path
};

}  // namespace slalom::vehicle::detail
