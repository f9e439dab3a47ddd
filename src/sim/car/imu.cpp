#include "slalom/sim/imu.hpp"

namespace slalom::sim {

Imu::Imu(const ImuOptions& options) : options_(options), random_({options.seed, 0}) {
  validate_options(options_, "imu");
}

void Imu::reset(const CarState& state) noexcept {
  random_ = RandomStream({options_.seed, 0});
  bias_.yaw_rate = options_.gyro_bias * random_.normal();
  bias_.forward = options_.accelerometer_bias * random_.normal();
  bias_.leftward = options_.accelerometer_bias * random_.normal();
  before_ = state;
  sum_ = last_ = {};
  samples_ = 0;
}

void Imu::update(const CarState& state, double time_step) noexcept {
  if (!(time_step > 0) || !std::isfinite(time_step) || !state.is_finite()) return;
  // The change of the velocity over the step, seen from the body in the middle of it.
  const double yaw = before_.yaw + 0.5 * std::remainder(state.yaw - before_.yaw, 2 * 3.141592653589793);
  const double from = before_.yaw + before_.slip - yaw, to = state.yaw + state.slip - yaw;
  const double forward = (state.speed * std::cos(to) - before_.speed * std::cos(from)) / time_step;
  const double leftward = (state.speed * std::sin(to) - before_.speed * std::sin(from)) / time_step;
  sum_.yaw_rate += state.yaw_rate + bias_.yaw_rate + options_.gyro_noise * random_.normal();
  sum_.forward += forward + bias_.forward + options_.accelerometer_noise * random_.normal();
  sum_.leftward += leftward + bias_.leftward + options_.accelerometer_noise * random_.normal();
  ++samples_;
  before_ = state;
}

ImuReading Imu::read() noexcept {
  if (samples_ > 0) {
    last_ = {sum_.yaw_rate / samples_, sum_.forward / samples_, sum_.leftward / samples_};
    sum_ = {};
    samples_ = 0;
  }
  return last_;
}

}  // namespace slalom::sim
