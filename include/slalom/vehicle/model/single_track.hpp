#pragma once

#include "slalom/maps/command.hpp"
#include "slalom/vehicle/model/single_track_dynamics.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle {

/// The single-track model with slipping tyres as a motion model; steering and acceleration are the inputs.
/// No more acceleration takes effect than motor, brakes and the grip that turning leaves allow, and the
/// path's speed is a limit unless plans seek the shortest time.
class SingleTrack {
 public:
  template <class T>
  using State = SingleTrackState<T>;   ///< state of the dynamics
  using Options = SingleTrackOptions;  ///< the model's own options

  static constexpr const char* name = "single_track";  ///< name in configurations
  /// Description, in one line.
  static constexpr const char* help =
      "single-track model with slipping tyres; steering and acceleration are the inputs";
  static constexpr int inputs = 2;                                      ///< inputs of a step
  static constexpr bool long_steps = true;                              ///< see Problem
  static constexpr std::array input_names{"steering", "acceleration"};  ///< names of the inputs

  /// Takes the options of the car. Throws std::invalid_argument where `hold_first_input` is set, which this
  /// model does not have, and where the radius of gyration, sqrt(inertia / mass), is not 0.1 to 1 wheelbase.
  explicit SingleTrack(const PathTrackingOptions& options, const Options& own = {});

  /// The state at the start.
  State<double> start(const VehicleStart& start, double reference_speed) const noexcept;

  /// Adds the facts about tyres and motor that the planner needs.
  void complete(VehicleTraits& traits) const noexcept;

  /// Sets the friction and the range of speeds that rollouts assume.
  void set_conditions(const DrivingConditions& conditions) noexcept {
    friction_ = conditions.friction;
    slowest_ = -conditions.reverse;
    fastest_ = conditions.reverse > 0 ? 0.0 : conditions.top_speed;
  }

  /// The car `duration` (s) later on ground of this friction, where this command acts all the time; with a
  /// speed that is not finite it rolls.
  VehicleStart advance(const VehicleStart& start, const Command& command, double duration,
                       double friction) const noexcept;

  /// The speed (m/s) to command at `speed` (m/s), so that the car's speed control brings about this mean
  /// acceleration (m/s^2) over `period` (s).
  double commanded_speed(double speed, double acceleration, double period) const noexcept;

  /// Whether plans seek the shortest time.
  bool seeks_lap_time() const noexcept { return own_.objective == Objective::lap_time; }

  /// The dynamics.
  const SingleTrackDynamics& dynamics() const noexcept { return dynamics_; }

  /// The steering command (rad) of an input: the whole of it at a standstill, half of it at
  /// `half_steer_speed`. So the same input turns the car about as much at any speed, where the angles that
  /// the tyres can use fall with its square. It is at most 1.5 rad: an input that is reasonable at speed may
  /// ask for whole turns once the car is slow.
  template <class T>
  SLALOM_INLINE T steering(const State<T>& s, const T& input) const {
    const T share = T(squared_half_steer_speed_) / (T(squared_half_steer_speed_) + square(s.speed));
    return clamp(input * share, T(-1.5), T(1.5));
  }
  /// The acceleration (m/s^2) that takes effect if `wanted` is asked for at this speed (m/s) of the path.
  template <class T>
  SLALOM_INLINE T limited(const State<T>& s, const T& reference_speed, const T& wanted) const {
    const T grip = dynamics_.grip_left(s, T(friction_)), braking = dynamics_.braking_limit(grip);
    const T driving = min(dynamics_.driving_limit(s.speed), grip);
    const T to_speed = T(inverse_time_step_);
    const T fastest = min(reference_speed * T(max_path_speed_share_), T(fastest_));
    const T asked = clamp(min(wanted, (fastest - s.speed) * to_speed), -braking, driving);
    return max(asked, min((T(slowest_) - s.speed) * to_speed, braking));
  }

  /// The state after a step; `reference_speed` (m/s) is that of the path.
  template <class T>
  SLALOM_INLINE State<T> step(const State<T>& s, const T& reference_speed, const Input<T, 2>& u, int) const {
    return dynamics_.advance(s, dynamics_.lagged(s.steer, steering(s, u[0])),
                             limited(s, reference_speed, u[1]), T(friction_), T(time_step_));
  }

  /// m, in which the car stops from a state without leaving a curve; 0 in reverse.
  template <class T>
  SLALOM_INLINE T stopping_distance(const State<T>& s) const {
    return square(max(s.speed, T(0))) * (T(stopping_distance_) / T(friction_));
  }
  /// The cost of ending where the car cannot stop before an obstacle, times the share of its energy.
  double collision_ahead_cost() const noexcept { return own_.collision_ahead_cost; }

  /// The cost of grip that a state needs beyond the usable share: for turning, or where plans seek the
  /// shortest time, for all that the step before it did.
  template <class T>
  SLALOM_INLINE T grip_cost(const State<T>& s) const {
    const T force = seeks_lap_time() ? sqrt(s.squared_force) : abs(s.speed * s.yaw_rate);
    const T excess = max(dynamics_.grip_share(force, T(friction_)) - T(usable_grip_), T(0));
    return T(grip_weight_) * square(excess);
  }

  /// The time steps that a car loses until it has reached this speed (m/s) of the profile, from the speed of
  /// a state below it: (p - v)^2 / (2 a p), with the usable grip a.
  template <class T>
  SLALOM_INLINE T steps_behind(const State<T>& s, const T& profile) const {
    const T missing = max(profile - s.speed, T(0));
    return square(missing) * T(inverse_speeding_up_) / (T(friction_) * max(profile, T(0.5)));
  }
  /// The cost of the share of grip that a car which drives on at a speed above that of the profile (m/s)
  /// needs beyond the usable grip, which is all in use at the speed of the profile.
  template <class T>
  SLALOM_INLINE T overspeed_cost(const State<T>& s, const T& profile) const {
    const T ratio = s.speed / max(profile, T(0.5));
    return T(grip_weight_) * square(T(usable_grip_) * max(square(ratio) - T(1), T(0)));
  }

 private:
  SingleTrackDynamics dynamics_;
  Options own_;
  Coefficient friction_;
  Coefficient time_step_, inverse_time_step_;
  Coefficient max_path_speed_share_;  ///< times the path's speed: what plans do not exceed
  Coefficient inverse_speeding_up_;   ///< s^2/m over time steps, times the friction
  Coefficient squared_half_steer_speed_;
  Coefficient slowest_{0}, fastest_{1e3};  ///< m/s
  Coefficient max_deceleration_;
  Coefficient usable_grip_, grip_weight_;
  Coefficient stopping_distance_;  ///< s^2/m, times the squared speed over the friction
};

}  // namespace slalom::vehicle
