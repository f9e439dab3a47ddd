#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle {

/// The values of the maps at a state.
template <class T>
struct Surroundings {
  T distance;  ///< m to the path
  T yaw;       ///< rad, of the path; off the reference map the yaw error to assume
  T speed;     ///< m/s, reference
  T outside;   ///< 1 off the reference map, else 0 or less (see maps::ReferenceField::set_curvatures)
  T obstacle;  ///< cost map value, 100 in collision; negative off the map
};

/// The cost of a state that follows a path (see PathTracking), and its look-ups in the reference field.
class TrackingCost {
 public:
  /// Takes the options of the car.
  explicit TrackingCost(const PathTrackingOptions& options);

  /// Cells {distance, yaw, speed, outside} in the map frame, as Surroundings has them.
  void set_reference(const GridView<4>& reference) noexcept { reference_ = reference; }

  /// Sets direction and urgency. In reverse, progress counts backwards, up to the speed of reverse.
  void set_conditions(const DrivingConditions& conditions) noexcept;

  /// Counts progress beyond the path's speed as time won. The sum over a plan's steps is then, but for a
  /// constant, the time from its end to the finish at the path's speeds.
  void set_lap_time() noexcept { min_lost_ = -1e3; }

  /// Looks up the maps at a position (m, map frame) with this cost map value.
  template <class T>
  SLALOM_INLINE Surroundings<T> look_up(const T& x, const T& y, const T& speed, const T& obstacle) const {
    if (localisation_less_) return {T(0), T(0), speed, T(0), obstacle};
    const CellValues<T> reference = slalom::look_up(reference_, x, y);
    return {reference.a, reference.b, reference.c, reference.d, obstacle};
  }

  /// The path's yaw (rad) at a position (m, map frame); `otherwise` off the map.
  template <class T>
  SLALOM_INLINE T path_yaw(const T& x, const T& y, const T& otherwise) const {
    if (localisation_less_) return otherwise;
    const CellValues<T> reference = slalom::look_up(reference_, x, y);
    return select(reference.d > T(0), otherwise, reference.b);
  }

  /// Cost and collision of a state with this yaw (rad, map frame).
  template <class T>
  SLALOM_INLINE Cost<T> stage(const T& yaw, const Surroundings<T>& seen) const {
    return cost(yaw, seen, distance_weight_, yaw_weight_, outside_cost_);
  }
  /// The cost of the last state of a sequence.
  template <class T>
  SLALOM_INLINE Cost<T> terminal(const T& yaw, const Surroundings<T>& seen) const {
    return cost(yaw, seen, terminal_distance_weight_, terminal_yaw_weight_, outside_terminal_cost_);
  }
  /// `cost` with the cost of driving at `speed` (m/s) below the path's.
  template <class T>
  SLALOM_INLINE Cost<T> with_speed(const Cost<T>& cost, const T& speed, const Surroundings<T>& seen) const {
    return {cost.value + T(speed_weight_) * square(max(seen.speed - speed, T(0))), cost.collided};
  }
  /// `cost` with the time that is lost in a step at this yaw (rad) and speed (m/s), as a share of the step's:
  /// the share by which the progress along the path is below the path's speed. With set_lap_time() it is
  /// negative above the path's speed.
  template <class T>
  SLALOM_INLINE Cost<T> with_time_lost(const Cost<T>& cost, const T& yaw, const T& speed,
                                       const Surroundings<T>& seen) const {
    const T error = wrap_angle(yaw - seen.yaw);
    const T along = max(T(1) - T(0.45) * square(error), T(-1)) * T(way_);
    const T wanted = min(seen.speed, T(fastest_));
    const T progress = along * select(seen.outside < T(0), -seen.outside, T(1));
    const T lost = (wanted - speed * progress) / max(wanted, T(0.5));
    return {cost.value + T(speed_weight_) * max(lost, T(min_lost_)), cost.collided};
  }

  /// The cost of so many time steps that are lost.
  template <class T>
  SLALOM_INLINE T time_cost(const T& steps) const {
    return T(speed_weight_) * steps;
  }

  /// The part of the cost of a state, the last one or another, that collisions make.
  double collision_part(const Surroundings<double>& seen, bool last) const {
    return collision(seen, last ? outside_terminal_cost_ : outside_cost_);
  }
  /// The part that the distance to the path makes.
  double distance_part(const Surroundings<double>& seen, bool last) const {
    return double(last ? terminal_distance_weight_ : distance_weight_) * square(seen.distance);
  }

 private:
  template <class T>
  SLALOM_INLINE T collision(const Surroundings<T>& seen, const Coefficient& outside) const {
    return T(collision_weight_) * select(seen.obstacle < T(0), T(outside), seen.obstacle);
  }
  template <class T>
  SLALOM_INLINE Cost<T> cost(const T& yaw, const Surroundings<T>& seen, const Coefficient& distance_weight,
                             const Coefficient& yaw_weight, const Coefficient& outside) const {
    T value = collision(seen, outside);
    if (!localisation_less_) {
      const T yaw_error = select(seen.outside > T(0), seen.yaw, wrap_angle(yaw - seen.yaw));
      value = value + (T(distance_weight) * square(seen.distance) + T(yaw_weight) * square(yaw_error));
    }
    return {value, mask_t<T>((seen.obstacle < T(0)) | (seen.obstacle >= T(100)))};
  }

  GridView<4> reference_;
  TrackingCostOptions options_;
  bool localisation_less_;
  Coefficient distance_weight_, yaw_weight_, outside_cost_;
  Coefficient terminal_distance_weight_, terminal_yaw_weight_, outside_terminal_cost_;
  Coefficient speed_weight_;
  Coefficient min_lost_{0};            ///< share of a step
  Coefficient way_{1}, fastest_{1e3};  ///< 1 forwards, -1 backwards; m/s
  Coefficient collision_weight_;
};

}  // namespace slalom::vehicle
