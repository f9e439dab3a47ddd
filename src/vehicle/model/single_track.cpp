#include "slalom/vehicle/model/single_track.hpp"

#include "slalom/core/gravity.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::vehicle {

namespace {

constexpr double tyre_shape = 1.5;     // C of Pacejka's curve
constexpr double max_step = 0.0125;    // s, of a prediction by commands
constexpr double braking_share = 0.8;  // share of the usable grip that curves leave for braking

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
      steer_time_constant_(car.steer_time_constant),
      max_deceleration_(car.max_deceleration),
      max_power_(car.max_acceleration * own.switch_speed),
      switch_speed_(own.switch_speed),
      usable_acceleration_(own.usable_grip * gravity),
      min_squared_share_(own.objective == Objective::lap_time ? 1.0 / 9 : 0.01),
      braking_share_(own.braking_share),
      negative_inverse_braking_share_(-1 / own.braking_share),
      gravity_(gravity),
      inverse_gravity_(1 / gravity) {}

double slip_of(const SingleTrackState<double>& s) noexcept {
  const double along = std::copysign(std::max(std::abs(s.speed), 0.1), s.speed);
  return std::asin(std::clamp(s.lateral / along, -1.0, 1.0));
}

double SingleTrackDynamics::lagged(double steer, double command, double dt) const noexcept {
  return steer + (command - steer) * (1 - std::exp(-dt / steer_time_constant_));
}

SingleTrack::SingleTrack(const PathTrackingOptions& options, const Options& own)
    : dynamics_(options, own),
      own_(own),
      friction_(own.friction),
      time_step_(options.time_step),
      inverse_time_step_(1 / options.time_step),
      max_path_speed_share_(own.objective == Objective::lap_time ? own.speed_share : 1),
      inverse_speeding_up_(1 / (2 * own.usable_grip * gravity * options.time_step)),
      squared_half_steer_speed_(own.half_steer_speed * own.half_steer_speed),
      max_deceleration_(options.max_deceleration),
      usable_grip_(own.usable_grip),
      grip_weight_(own.grip_weight),
      stopping_distance_(1 / (2 * braking_share * own.usable_grip * gravity)) {
  if (options.hold_first_input)
    throw std::invalid_argument(
        "vehicle.hold_first_input: must be false with vehicle.model 'single_track', whose start the planner "
        "predicts by the dead time");
  // With mass far from the axles, or all in one place, the yaw rate changes faster than a step resolves.
  const double gyration = std::sqrt(own.inertia / own.mass) / options.wheelbase();
  if (gyration < 0.1 || gyration > 1)
    throw std::invalid_argument(
        "vehicle.inertia: the radius of gyration, sqrt(inertia / mass), is " + std::to_string(gyration) +
        " of the wheelbase, must be 0.1 to 1 of it with vehicle.model 'single_track'");
}

void SingleTrack::complete(VehicleTraits& traits) const noexcept {
  traits.tyres = {.friction = own_.friction,
                  .usable_grip = own_.usable_grip,
                  .braking_share = own_.braking_share,
                  .seeks_lap_time = seeks_lap_time(),
                  .half_steer_speed = own_.half_steer_speed,
                  .stopping_deceleration = braking_share * own_.usable_grip * gravity * own_.friction,
                  .switch_speed = own_.switch_speed};
}

SingleTrack::State<double> SingleTrack::start(const VehicleStart& start, double) const noexcept {
  const maps::Pose& at = start.pose;
  const double lateral = start.speed * std::sin(start.slip);
  return {at.x, at.y, at.yaw, start.speed, start.steer, start.yaw_rate, lateral};
}

VehicleStart SingleTrack::advance(const VehicleStart& start, const Command& command, double duration,
                                  double friction) const noexcept {
  State<double> s = this->start(start, 0);
  const int pieces = saturate_cast<int>(std::ceil(duration / max_step - 1e-9));
  const double dt = duration / pieces;
  for (int i = 0; i < pieces; ++i) {
    double acceleration = 0;
    if (std::isfinite(command.speed)) {
      const double error = command.speed - s.speed;
      acceleration = (error * s.speed >= 0 ? own_.speed_gain : own_.brake_gain) * error;
      acceleration = std::clamp(acceleration, -double(max_deceleration_), dynamics_.driving_limit(s.speed));
    }
    s = dynamics_.advance(s, dynamics_.lagged(s.steer, command.steer, dt), acceleration, friction, dt);
  }
  return {{s.x, s.y, s.yaw}, s.speed, s.steer, s.yaw_rate, slip_of(s)};
}

double SingleTrack::commanded_speed(double speed, double acceleration, double period) const noexcept {
  const double gain = acceleration * speed >= 0 ? own_.speed_gain : own_.brake_gain;
  return speed + acceleration * period / (1 - std::exp(-gain * period));
}

}  // namespace slalom::vehicle
