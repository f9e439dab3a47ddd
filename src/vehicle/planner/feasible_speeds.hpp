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
  double braking_share = 1;  ///< share of the grip that turning leaves, for braking
  double delay = 0;          ///< s, by which the car follows the speeds late
  double lead = 0;           ///< s, from where a speed is looked up to where the car has it
  double switch_speed = 7;   ///< m/s, above it the motor's power is the limit
};

/// The limits of a model with tyres that slip, on ground of this friction.
DrivingLimits driving_limits(const VehicleTraits& traits, double friction);

/// The highest speeds along a path that a car can drive, no higher than the path's own:
///
///     v^2 |k| <= grip,   -braking <= dv/dt <= acceleration,   (v^2 k)^2 + (b dv/dt)^2 <= grip^2
///
/// with b = 1 / braking_share for dv/dt < 0, else 1, by a pass forward and one backward (Heilmeier et al.
/// 2020, Sec. 4; see speed_profile). At every point they are slow enough for all that follows; with `lead`
/// they are those of the place that a car reaches in this time, so higher than the car can drive at the point
/// itself where they rise. Where feasible_speeds is computed once, this follows the friction while the car
/// drives.
class FeasibleSpeeds {
 public:
  /// `grip_shares`: of the grip in the limits, one for each of so many equal parts of the path; at least one.
  explicit FeasibleSpeeds(std::span<const maps::ReferencePoint> path,
                          std::span<const double> grip_shares = std::span(&whole, 1));

  /// Computes the speeds. Allocates nothing.
  void update(const DrivingLimits& limits) noexcept;

  /// m along the path, of a point.
  double arc(int point) const noexcept { return arc_[static_cast<std::size_t>(point)]; }
  /// m, of a closed path; 0 of an open one.
  double length() const noexcept { return gap_.back() > 0 ? arc_.back() + gap_.back() : 0; }

  /// 1/m, of the path, positive to the left, a point each.
  std::span<const double> curvatures() const noexcept { return curvature_; }
  /// m/s, a point each, looked up ahead with `lead`; those of the path before the first update.
  std::span<const double> speeds() const noexcept { return speed_; }

 private:
  static constexpr double whole = 1;

  void anticipate(double delay) noexcept;
  void look_ahead(double lead) noexcept;

  std::vector<double> own_, speed_;  ///< m/s
  std::vector<double> profile_;      ///< m/s, before they are looked up ahead
  std::vector<double> arc_;          ///< m
  std::vector<double> curvature_;    ///< 1/m, positive to the left
  std::vector<double> share_;        ///< share of the grip at each point
  std::vector<double> gap_;          ///< m, from each point to the next; 0 where the path is not joined
};

}  // namespace slalom::vehicle::detail
