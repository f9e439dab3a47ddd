#pragma once

#include "slalom/vehicle/model/actuation.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle {

/// The kinematic bicycle about its rear axle,
///
///     x' = v cos(yaw)    y' = v sin(yaw)    yaw' = v tan(steer) / (l_f + l_r)
///
/// (R. Rajamani, "Vehicle Dynamics and Control", 2nd ed., section 2.2, with the slip angle 0 at the rear
/// axle). The steering has a dead time and a first-order lag.
class KinematicBicycle {
 public:
  /// The steering command that is held, rad, is a state too.
  template <class T>
  struct State {
    T x, y, yaw;  ///< m, m, rad, of the rear axle, map frame
    T speed;      ///< m/s
    T steer;      ///< rad, of the wheels
    T held;       ///< rad, the sequence's first input while it is held
  };
  using Options = NoOptions;  ///< the model's own options

  /// Takes the options of the car.
  explicit KinematicBicycle(const PathTrackingOptions& options);

  /// The state at the start; the reference speed (m/s) is the target of SpeedModel::linear.
  State<double> start(const VehicleStart& start, double reference_speed) noexcept;

 protected:
  /// The state after step `k` with this steering input (rad), at `next_speed` (m/s).
  template <class T>
  SLALOM_INLINE State<T> moved(const State<T>& s, const T& steering, const T& next_speed, int k) const {
    State<T> next;
    const T command = steering_.acting(s.held, steering, k);
    next.held = steering_.held(s.held, steering, k);
    next.speed = next_speed;
    const T travelled = s.speed * T(time_step_);
    T sin_steer, cos_steer, sin_yaw, cos_yaw;
    sin_cos_half_turn(s.steer, sin_steer, cos_steer);
    sin_cos(s.yaw, sin_yaw, cos_yaw);
    next.yaw = s.yaw + travelled * T(inverse_wheelbase_) * sin_steer / cos_steer;
    next.x = s.x + travelled * cos_yaw;
    next.y = s.y + travelled * sin_yaw;
    next.steer = steering_.turned(s.steer, command);
    return next;
  }

  SpeedPrediction speed_;  ///< prediction of the speed

 private:
  SteeringActuator steering_;
  Coefficient time_step_;
  Coefficient inverse_wheelbase_;
};

/// The kinematic bicycle with the steering as its input; its speed follows SpeedModel.
class Kinematic : public KinematicBicycle {
 public:
  static constexpr const char* name = "kinematic";  ///< name in configurations
  /// Description, in one line.
  static constexpr const char* help = "kinematic bicycle; the steering is the input, the speed is the path's";
  static constexpr int inputs = 1;                      ///< inputs of a step
  static constexpr std::array input_names{"steering"};  ///< names of the inputs

  /// Takes the options of the car.
  explicit Kinematic(const PathTrackingOptions& options, const Options& = {}) : KinematicBicycle(options) {}

  /// The state after step `k`; `reference_speed` (m/s) is that of the path.
  template <class T>
  SLALOM_INLINE State<T> step(const State<T>& s, const T& reference_speed, const Input<T, 1>& u,
                              int k) const {
    return moved(s, u[0], speed_.following(s.speed, reference_speed), k);
  }
};

/// The kinematic bicycle with steering and acceleration as its inputs. The acceleration is limited by
/// `max_deceleration` and `max_acceleration`, and the path's speed is a limit.
class KinematicAcceleration : public KinematicBicycle {
 public:
  static constexpr const char* name = "kinematic_acceleration";  ///< name in configurations
  /// Description, in one line.
  static constexpr const char* help = "kinematic bicycle; steering and acceleration are the inputs";
  static constexpr int inputs = 2;                                      ///< inputs of a step
  static constexpr std::array input_names{"steering", "acceleration"};  ///< names of the inputs

  /// Takes the options of the car.
  explicit KinematicAcceleration(const PathTrackingOptions& options, const Options& = {})
      : KinematicBicycle(options) {}

  /// The state after step `k`; `reference_speed` (m/s) is that of the path.
  template <class T>
  SLALOM_INLINE State<T> step(const State<T>& s, const T& reference_speed, const Input<T, 2>& u,
                              int k) const {
    return moved(s, u[0], speed_.accelerated(s.speed, reference_speed, u[1]), k);
  }
};

}  // namespace slalom::vehicle
