#include "slalom/sim/wheel_odometry.hpp"

namespace slalom::sim {

WheelOdometry::WheelOdometry(const CarParameters& car, const WheelOdometryOptions& options)
    : car_(car), options_(options), random_({options.seed, 0}) {
  validate_options(car_, "car");
  validate_options(options_, "wheel_odometry");
}

void WheelOdometry::reset(const CarState& state) noexcept {
  random_ = RandomStream({options_.seed, 0});
  pose_ = {};
  speed_ = true_speed_ = state.speed;
  yaw_rate_ = 0;
}

void WheelOdometry::update(const CarState& state, double time_step) noexcept {
  if (!(time_step > 0) || !std::isfinite(time_step) || !state.is_finite()) return;
  const double acceleration = (state.speed - true_speed_) / time_step;
  true_speed_ = state.speed;
  // The speed along the body is that of the rear wheels; sideways slip turns no wheel.
  const double along = state.speed * std::cos(state.slip);
  speed_ = along * (1 + options_.speed_gain_error) * (1 + options_.slip_per_acceleration * acceleration) +
           options_.speed_noise * random_.normal();
  if (options_.yaw_from_gyro) {
    yaw_rate_ = state.yaw_rate + options_.gyro_bias + options_.gyro_noise * random_.normal();
  } else {
    const double steer = state.steer * (1 + options_.steer_gain_error) + options_.steer_offset;
    yaw_rate_ = speed_ * std::tan(steer) / car_.wheelbase();
  }
  const double middle = pose_.yaw + 0.5 * yaw_rate_ * time_step;
  pose_.x += speed_ * std::cos(middle) * time_step;
  pose_.y += speed_ * std::sin(middle) * time_step;
  pose_.yaw = maps::wrap_angle(pose_.yaw + yaw_rate_ * time_step);
}

maps::Pose rear_axle(const CarParameters& car, const CarState& state) noexcept {
  return {state.x - car.rear_length * std::cos(state.yaw), state.y - car.rear_length * std::sin(state.yaw),
          state.yaw};
}

}  // namespace slalom::sim
