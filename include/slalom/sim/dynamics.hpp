#pragma once

#include "slalom/sim/car.hpp"

namespace slalom::sim {

/// How a car moves: single-track ("bicycle") models, with front and rear wheels merged into one each.
///
/// - `kinematic`: no wheel slips sideways;
///   slip = atan(l_r / L tan(steer)), yaw rate = v cos(slip) tan(steer) / L.
/// - `single_track`: linear tyres with load transfer, the STM of Althoff & Wuersching, "CommonRoad: Vehicle
///   Models" (2020), section 6; below 0.5 m/s the kinematic model. There F_y = mu C_S F_z alpha without
///   bound. With speed < 0 the slip angle is measured against |v|, which the source does not do (its tyres
///   then push the wrong way and the state explodes).
/// - `saturating`: the same car with tyres after Pacejka, "Tire and Vehicle Dynamics", eq. 1.5 with E = 0,
///   F_y = mu F_z sin(C atan(B alpha)), C = 1.5, B = C_S / C: the same slope at 0, but grip can be exceeded.
///   Driving and braking forces reduce the largest sideways force (friction ellipse).
enum class Model { kinematic, single_track, saturating };
inline const char* const* enum_names(Model) {
  static constexpr const char* names[] = {"kinematic", "single_track", "saturating", nullptr};
  return names;
}

/// Integration method of a step.
enum class Integrator { runge_kutta_4, euler };
inline const char* const* enum_names(Integrator) {
  static constexpr const char* names[] = {"runge_kutta_4", "euler", nullptr};
  return names;
}

/// Options of the car dynamics.
struct DynamicsOptions {
  Model model = Model::single_track;                  ///< equations of motion
  Integrator integrator = Integrator::runge_kutta_4;  ///< integration method
  /// Equal parts into which a time step is cut; 0 takes as many as keep the tyres' fastest mode stable.
  int substeps = 0;
  /// As f1tenth_gym: below 0.5 m/s the car moves along its axis and the slip angle does not change; the last
  /// move towards the steering's limit may pass it; in reverse the tyres push the wrong way.
  bool gym = false;
};

/// Speed (m/s) below which single_track and saturating fall back to the kinematic model.
inline constexpr double kinematic_below = 0.5;

/// d(state)/dt under the input, which the limits of actuator, motor and brakes cut; each field is the
/// derivative of the state's field of that name.
CarState derivative(const CarParameters& car, const DynamicsOptions& options, const CarState& state,
                    const DriveInput& input) noexcept;

/// The state after `time_step` (s). The yaw is not wrapped.
CarState advance(const CarParameters& car, const DynamicsOptions& options, const CarState& state,
                 const DriveInput& input, double time_step) noexcept;

/// The number of substeps that `options` give for a time step (s).
int substeps(const CarParameters& car, const DynamicsOptions& options, double time_step) noexcept;

}  // namespace slalom::sim
