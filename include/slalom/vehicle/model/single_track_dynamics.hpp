#pragma once

#include "slalom/core/math.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "slalom/vehicle/model/single_track_options.hpp"

namespace slalom::vehicle {

/// The state of a single-track car with slipping tyres.
template <class T>
struct SingleTrackState {
  T x, y, yaw;  ///< m, m, rad, of the rear axle, map frame
  T speed;      ///< v, m/s, along the direction of travel of the centre of gravity; negative in reverse
  T steer;      ///< delta, rad, of the front wheels
  T yaw_rate;   ///< r, rad/s
  T lateral;    ///< v_y, m/s, sideways velocity of the centre of gravity in the body's frame; v sin(slip)
  T squared_force = T(0);  ///< m^2/s^4, of the last step's mean force over mass, braking over braking_share
};

/// The slip angle of a state, rad, from the body's axis to the direction of travel of the centre of gravity.
double slip_of(const SingleTrackState<double>& s) noexcept;

/// Single-track ("bicycle") dynamics with slipping tyres, for steps as long as a prediction's, at any speed:
///
///     v_y' = F_f + F_r - v r          F_f = K_f (sign(v) delta - (v_y + l_f r) / |v|)
///     r'   = m / I_z (l_f F_f - l_r F_r)    F_r = -K_r (v_y - l_r r) / |v|
///     v'   = a
///
/// with the forces over the mass, the stiffnesses K_i = mu C_Si L_i and the axle loads over the mass
/// L_f = (g l_r - a h) / L, L_r = (g l_f + a h) / L: the single-track model of Althoff & Wuersching,
/// "CommonRoad: Vehicle Models" (2020), section 6, in body velocities. With saturating tyres the stiffness is
/// the secant of Pacejka's curve sin(C atan(C_S / C alpha)), C = 1.5 ("Tire and Vehicle Dynamics", eq. 1.5),
/// at the old slip angle, times the share of grip that drive or brakes leave.
///
/// Their two modes are as fast as 113 / v and 52 / v 1/s, so a step is implicit: a theta method with
/// theta = (z + 3) / (z + 6), z the step over the modes' mean time constant. The equations are multiplied by
/// |v|; at a standstill they yield the kinematic bicycle. docs/vehicle-model.md has the derivation.
class SingleTrackDynamics {
 public:
  /// Takes the geometry and limits of the car and the options of its tyres.
  SingleTrackDynamics(const PathTrackingOptions& car, const SingleTrackOptions& own);

  /// The friction in the options.
  double friction() const noexcept { return double(friction_); }
  double wheelbase() const noexcept { return double(front_length_) + double(rear_length_); }  ///< m

  /// The acceleration (m/s^2, to either side) that tyres which turn the car leave for drive and brakes: with
  /// lateral acceleration v r no more than `usable_grip` of friction times gravity is used, and a part is
  /// always left to slow down: a tenth, or where plans seek the shortest time, a third.
  template <class T>
  SLALOM_INLINE T grip_left(const SingleTrackState<T>& s, const T& friction) const {
    const T most = friction * T(usable_acceleration_), turning = s.speed * s.yaw_rate;
    return sqrt(max(square(most) - square(turning), T(min_squared_share_) * square(most)));
  }
  /// The mean deceleration (m/s^2) of a step where tyres have `grip` left: `braking_share` of it, and never
  /// more than `max_deceleration`.
  template <class T>
  SLALOM_INLINE T braking_limit(const T& grip) const {
    return min(T(braking_share_) * grip, T(max_deceleration_));
  }
  /// The acceleration (m/s^2) of the motor at this speed: its power limits it above `switch_speed`.
  template <class T>
  SLALOM_INLINE T driving_limit(const T& speed) const {
    return T(max_power_) / max(abs(speed), T(switch_speed_));
  }
  /// The share of friction times gravity that a force over the mass (m/s^2) uses.
  template <class T>
  SLALOM_INLINE T grip_share(const T& force, const T& friction) const {
    return force * (T(inverse_gravity_) / friction);
  }

  /// The wheels' angle (rad) after a step of the prediction, as the steering's lag would have it.
  template <class T>
  SLALOM_INLINE T lagged(const T& steer, const T& command) const {
    return steer + (command - steer) * T(steer_share_);
  }
  /// The steering angle after `dt` (s).
  double lagged(double steer, double command, double dt) const noexcept;

  /// The state after `dt` (s) in which the wheels turn towards this angle (rad), no faster than their rate,
  /// with this acceleration (m/s^2, within the limits of motor, brakes and tyres) on ground of this friction.
  template <class T>
  SLALOM_INLINE SingleTrackState<T> advance(const SingleTrackState<T>& s, const T& angle,
                                            const T& acceleration, const T& friction, const T& dt) const {
    SingleTrackState<T> next;
    const T reach = T(steer_rate_) * dt;
    const T turned = clamp(angle - s.steer, -reach, reach);
    next.steer = s.steer + turned;

    const T half = T(0.5) * dt, middle_speed = s.speed + half * acceleration;
    const T rolling = abs(middle_speed), way = select(middle_speed < T(0), T(-1), T(1));
    T front = friction * (T(front_stiffness_) - T(front_transfer_) * acceleration);
    T rear = friction * (T(rear_stiffness_) + T(rear_transfer_) * acceleration);
    const T inverse = T(1) / max(rolling, T(0.25));
    T drag(0);
    T steer = s.steer, next_steer = next.steer;  // as the tyres' slip angles take them
    if (saturating_) {
      // The slip angle of the front wheels is delta - atan(t) = (tan(delta) - t) cos(delta)^2 + ..., and
      // their force is sideways to them.
      const T squared = square(s.steer), flattened = T(1) - squared * (T(1) - squared * T(1.0 / 3));
      steer = steer + steer * squared * T(1.0 / 3);
      next_steer = next_steer + next_steer * square(next_steer) * T(1.0 / 3);
      front = max(front, T(0)) * flattened;
      rear = max(rear, T(0));
      const T front_slip = (steer * middle_speed - (s.lateral + T(front_length_) * s.yaw_rate)) * inverse;
      const T rear_slip = (T(rear_length_) * s.yaw_rate - s.lateral) * inverse;
      const T share = acceleration * (T(inverse_gravity_) / friction);
      const T left = sqrt(max(T(1) - square(share), T(0)));
      front = front * (left * secant(T(front_sharpness_) * front_slip * flattened));
      rear = rear * (left * secant(T(rear_sharpness_) * rear_slip));
      const T slip = way * s.lateral * inverse;
      // The angles are not small in a spin.
      const T grip = friction * T(gravity_);
      drag = clamp(rear * rear_slip * slip - front * front_slip * (s.steer - slip), -grip, grip);
      front = front * (T(1) - T(0.5) * squared);
    }
    const T missed = (next_steer - steer) * abs(turned) * (T(1) / reach);
    // The wheels turn at their rate and then stand: what counts of the move, by when it ends in the step.
    move_sideways(s, next, next_steer, missed, front, rear, acceleration, middle_speed, rolling, way, dt);

    next.speed = s.speed + dt * (acceleration + drag);
    next.yaw = s.yaw + half * (s.yaw_rate + next.yaw_rate);
    const T lateral = T(0.5) * (s.lateral + next.lateral);
    const T rate = T(0.5) * (s.yaw_rate + next.yaw_rate);
    const T sideways = (next.lateral - s.lateral) * (T(1) / dt) + middle_speed * rate;
    next.squared_force =
        square(sideways) + square(max(acceleration, acceleration * T(negative_inverse_braking_share_)));
    // The speed along the body: sqrt(v^2 - v_y^2), to third order in the slip angle.
    const T along = middle_speed - way * T(0.5) * square(lateral) * inverse;
    const T across = lateral - T(rear_length_) * rate;
    T sine, cosine;
    sin_cos(T(0.5) * (s.yaw + next.yaw), sine, cosine);
    next.x = s.x + dt * (along * cosine - across * sine);
    next.y = s.y + dt * (along * sine + across * cosine);
    return next;
  }

 private:
  /// sin(C atan(x)) / (C x) for C = 1.5, exactly, by the half angle.
  template <class T>
  static SLALOM_INLINE T secant(const T& x) {
    const T cosine = reciprocal_sqrt(T(1) + square(x));
    return cosine * (T(1) + cosine + cosine) * reciprocal_sqrt(T(4.5) * (T(1) + cosine));
  }

  /// Yaw rate and sideways velocity after the step, with these stiffnesses over the mass (m/s^2/rad).
  template <class T>
  SLALOM_INLINE void move_sideways(const SingleTrackState<T>& s, SingleTrackState<T>& next, const T& steer,
                                   const T& missed, const T& front, const T& rear, const T& acceleration,
                                   const T& speed, const T& rolling, const T& way, const T& dt) const {
    const T lf = T(front_length_), lr = T(rear_length_), ratio = T(mass_over_inertia_);
    const T front_moment = lf * front, rear_moment = lr * rear;
    // v_y' = -(a v_y + b r) / |v| + ..., r' = -(c v_y + d r) / |v| + ...
    const T slipping = front + rear, coupling = front_moment - rear_moment;
    const T a = slipping - way * T(speed_coupling_) * acceleration, b = coupling + speed * rolling;
    const T c = ratio * coupling, d = ratio * (lf * front_moment + lr * rear_moment);
    const T z = T(0.5) * dt * (slipping + d);
    const T old_part = T(3) * rolling, new_part = z + old_part, whole = new_part + old_part;  // over `whole`
    const T old_dt = old_part * dt, new_dt = new_part * dt;
    const T driven = dt * way * front * (whole * steer - old_part * missed);
    const T u = whole * rolling, push = rolling * driven;
    const T first = u * s.lateral - old_dt * (a * s.lateral + b * s.yaw_rate) + push;
    const T second = u * s.yaw_rate - old_dt * (c * s.lateral + d * s.yaw_rate) + ratio * lf * push;
    const T m11 = u + new_dt * a, m12 = new_dt * b, m21 = new_dt * c, m22 = u + new_dt * d;
    const T inverse = T(1) / max(m11 * m22 - m12 * m21, T(1e-9));
    // A car that spins is unstable, and over a long step the solution has a pole.
    next.lateral = clamp((first * m22 - second * m12) * inverse, T(-1e3), T(1e3));
    next.yaw_rate = clamp((second * m11 - first * m21) * inverse, T(-100), T(100));
  }

  bool saturating_;
  Coefficient friction_;
  Coefficient front_length_, rear_length_;
  Coefficient mass_over_inertia_;
  Coefficient front_stiffness_, rear_stiffness_;  ///< C_S g l / L, over the mass and the friction
  Coefficient front_transfer_, rear_transfer_;    ///< C_S h / L, change of it by 1 m/s^2
  Coefficient front_sharpness_, rear_sharpness_;  ///< C_S / C
  Coefficient speed_coupling_;                    ///< 1 where the source's linear model turns the force
  Coefficient steer_rate_, steer_share_;
  double steer_time_constant_;
  Coefficient max_deceleration_, max_power_, switch_speed_;
  Coefficient usable_acceleration_;  ///< over the friction
  Coefficient min_squared_share_;    ///< square of the share of the usable grip that is left to slow down
  Coefficient braking_share_, negative_inverse_braking_share_;
  Coefficient gravity_, inverse_gravity_;
};

}  // namespace slalom::vehicle
