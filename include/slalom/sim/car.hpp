#pragma once

namespace slalom::sim {

/// The parameters of a car. The defaults are the 1/10-scale car of f1tenth_gym.
struct CarParameters {
  double friction = 1.0489;        ///< mu, between tyre and road
  double cornering_front = 4.718;  ///< C_Sf, 1/rad, cornering stiffness over friction and axle load
  double cornering_rear = 5.4562;  ///< C_Sr, 1/rad, the same of the rear axle
  double front_length = 0.15875;   ///< l_f, m, from the centre of gravity to the front axle
  double rear_length = 0.17145;    ///< l_r, m
  double gravity_height = 0.074;   ///< h, m, of the centre of gravity
  double mass = 3.74;              ///< m, kg
  double inertia = 0.04712;        ///< I_z, kg m^2, about the vertical axis
  double steer_min = -0.4189;      ///< rad
  double steer_max = 0.4189;       ///< rad
  double steer_rate_max = 3.2;     ///< rad/s, either way
  double switch_speed = 7.319;     ///< m/s, above it the motor's power limits the acceleration
  double acceleration_max = 9.51;  ///< m/s^2, also of braking
  double speed_min = -5.0;         ///< m/s
  double speed_max = 20.0;         ///< m/s
  double length = 0.58;            ///< m, of the body, whose middle is the centre of gravity
  double width = 0.31;             ///< m

  /// Distance between the axles, m.
  double wheelbase() const { return front_length + rear_length; }

  /// A passenger car: parameter set 2 (a BMW 320i) of Althoff & Wuersching, "CommonRoad: Vehicle Models"
  /// (2020), as its single-track model uses them.
  static CarParameters full_scale();

  /// Throws std::invalid_argument naming the field, its value and the rule it breaks.
  void validate() const;
};

/// The cars whose parameters and LiDAR are known by name.
enum class CarKind {
  f1tenth,        ///< the 1/10-scale car of f1tenth_gym
  passenger_car,  ///< CarParameters::full_scale()
};
inline const char* const* enum_names(CarKind) {
  static constexpr const char* const names[] = {"f1tenth", "passenger_car", nullptr};
  return names;
}
/// The parameters of a car.
CarParameters parameters_of(CarKind kind);

/// The state of a car; its position is that of the centre of gravity.
struct CarState {
  double x = 0;         ///< m
  double y = 0;         ///< m
  double steer = 0;     ///< delta, rad, angle of the front wheels, to the left positive
  double speed = 0;     ///< v, m/s, along the direction of travel; negative in reverse
  double yaw = 0;       ///< psi, rad
  double yaw_rate = 0;  ///< rad/s
  double slip = 0;      ///< beta, rad, from the body's axis to the direction of travel

  bool operator==(const CarState&) const = default;
};

/// The inputs of the model; both are held over a time step.
struct DriveInput {
  double steer_rate = 0;    ///< rad/s
  double acceleration = 0;  ///< m/s^2
};

}  // namespace slalom::sim
