#include "slalom/vehicle/model/single_track.hpp"

#include <cmath>
#include <stdexcept>

namespace slalom::vehicle {

namespace {

constexpr double gravity = 9.81;    // m/s^2
constexpr double tyre_shape = 1.5;  // C of Pacejka's curve

}  // namespace

SingleTrackDynamics::SingleTrackDynamics(const PathTrackingOptions& car, const SingleTrackOptions& own)
    : saturating_(own.tyres == TyreModel::saturating),
      friction_(own.friction),
      front_length_(car.front_length),
      rear_length_(car.rear_length),
      mass_over_inertia_(own.mass / own.inertia),
      front_stiffness_(own.cornering_front * gravity * car.rear_length / car.wheelbase()),
      rear_stiffness_(own.cornering_rear * gravity * car.front_length / car.wheelbase()),
      front_transfer_(own.cornering_front * own.gravity_height / car.wheelbase()),
      rear_transfer_(own.cornering_rear * own.gravity_height / car.wheelbase()),
      front_sharpness_(own.cornering_front / tyre_shape),
      rear_sharpness_(own.cornering_rear / tyre_shape),
      speed_coupling_(saturating_ ? 0.0 : 1.0),
      steer_rate_(own.steer_rate),
      steer_share_(1 - std::exp(-car.time_step / car.steer_time_constant)),
      max_deceleration_(car.max_deceleration),
      max_power_(car.max_acceleration * own.switch_speed),
      switch_speed_(own.switch_speed),
      usable_acceleration_(own.usable_grip * gravity),
      inverse_gravity_(1 / gravity) {}

SingleTrack::SingleTrack(const PathTrackingOptions& options, const Options& own)
    : dynamics_(options, own),
      friction_(own.friction),
      time_step_(options.time_step),
      inverse_time_step_(1 / options.time_step),
      slowest_(0.0),
      usable_grip_(own.usable_grip),
      grip_weight_(own.grip_weight) {
  if (options.hold_first_input)
    throw std::invalid_argument(
        "vehicle.hold_first_input: must be false with vehicle.model 'single_track', whose start the planner "
        "predicts by the dead time");
}

SingleTrack::State<double> SingleTrack::start(const VehicleStart& start, double) const noexcept {
  return {start.pose.x,
          start.pose.y,
          start.pose.yaw,
          start.speed,
          start.steer,
          start.yaw_rate,
          start.speed * std::sin(start.slip)};
}

}  // namespace slalom::vehicle
