#pragma once

#include "slalom/core/problem.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

namespace slalom::vehicle {

/// The steering between a command and the wheels: dead time and first-order lag.
class SteeringActuator {
 public:
  /// Discretises the lag exactly for commands held during a step or, without `exact`, by explicit Euler.
  explicit SteeringActuator(const PathTrackingOptions& options, bool exact = true);

  /// The command (rad) that acts in step `k`: the step's input, or the first one while that is held.
  template <class T>
  SLALOM_INLINE T acting(const T& held, const T& input, int k) const {
    return hold_ && k != 0 && k <= held_steps_ ? held : input;
  }
  /// The input (rad) that the state after step `k` holds.
  template <class T>
  SLALOM_INLINE T held(const T& held, const T& input, int k) const {
    return hold_ && k == 0 ? input : held;
  }
  /// The wheels' angle (rad) after a step of this command.
  template <class T>
  SLALOM_INLINE T turned(const T& steer, const T& command) const {
    return steer + (command - steer) * T(lag_factor_);
  }

 private:
  bool hold_;
  int held_steps_;
  Coefficient lag_factor_;
};

/// The predicted speed of the next step.
class SpeedPrediction {
 public:
  /// Takes the options of the car.
  explicit SpeedPrediction(const PathTrackingOptions& options);

  /// The target of the linear model, m/s.
  void set_target(double speed) { target_speed_ = static_cast<float>(speed); }
  /// The change of speed in a step of the linear model above its target, m/s; positive slows down.
  void set_linear_loss(double loss) { linear_loss_ = loss; }

  /// The speed (m/s) after a step at `speed`, with this reference speed, where it is not an input.
  template <class T>
  SLALOM_INLINE T following(const T& speed, const T& reference) const {
    if (model_ == SpeedModel::constant) return speed;
    if (model_ == SpeedModel::linear) {
      const T target = T(target_speed_), faster = min(speed + T(speed_gain_), target);
      const T slower = max(speed - T(linear_loss_), target);
      return select(speed <= target, faster, slower);
    }
    if (!limited_) return reference;
    return min(max(reference, speed - T(speed_loss_)), speed + T(speed_gain_));
  }
  /// After a step with this acceleration (m/s^2) as far as the limits allow; never backwards, and no faster
  /// than the reference as soon as the brakes allow it.
  template <class T>
  SLALOM_INLINE T accelerated(const T& speed, const T& reference, const T& acceleration) const {
    const T slowest = speed - T(speed_loss_), fastest = min(speed + T(speed_gain_), max(reference, slowest));
    return max(min(max(speed + acceleration * T(time_step_), slowest), fastest), T(0));
  }

 private:
  SpeedModel model_;
  bool limited_;
  Coefficient time_step_;
  Coefficient speed_gain_;   ///< m/s a step
  Coefficient speed_loss_;   ///< m/s a step
  Coefficient linear_loss_;  ///< m/s a step
  Coefficient target_speed_;
};

}  // namespace slalom::vehicle
