#include "evaluation/hardware_model.hpp"

namespace slalom::evaluation {
namespace {

template <class Options>
Options seeded(Options options, std::uint64_t seed) {
  options.seed = seed;
  return options;
}

}  // namespace

HardwareConditions HardwareConditions::sensors(double range_noise, double dropout) {
  HardwareConditions conditions{.range_noise = range_noise,
                                .dropout = dropout,
                                .steering_dead_time = sim::PlantOptions{}.steering_dead_time,
                                .steering_time_constant = 0,
                                .steering_gain = 1,
                                .steering_offset = 0,
                                .speed_gain = sim::ActuationOptions{}.speed_gain,
                                .acceleration_max = sim::CarParameters{}.acceleration_max};
  // Near the limit of grip a car turns less than its steering says, so the odometry takes the yaw rate of a
  // gyro, and the localiser trusts it. The rear axle slips outwards, which the odometry does not know. With
  // all ranges the localiser sees the next corner from far down a straight.
  conditions.wheels.yaw_from_gyro = true;
  conditions.localiser.range_cap = 30;
  conditions.localiser.drift_noise = 0.01;
  conditions.localiser.yaw_noise = 0.002;
  conditions.localiser.turn_noise = 0.03;
  conditions.localiser.across_noise = 0.15;
  return conditions;
}

HardwareModel::HardwareModel(const HardwareConditions& conditions, const maps::OccupancyGrid& map,
                             const sim::CarParameters& car, const sim::CarState& state, std::uint64_t seed)
    : conditions_(conditions),
      car_(car),
      wheels_(car, seeded(conditions.wheels, seed)),
      imu_(seeded(conditions.inertial, ~seed)),
      localiser_(map, seeded(conditions.localiser, seed)) {
  wheels_.reset(state);
  imu_.reset(state);
  localiser_.start_at(sim::rear_axle(car, state));
}

void HardwareModel::apply(const HardwareConditions& conditions, sim::WorldOptions& options) {
  const double rate = options.lidar.rate;
  options.lidar = sim::LidarOptions::hokuyo_utm_30lx();
  options.lidar.rate = rate;
  options.lidar.noise = conditions.range_noise;
  options.lidar.dropout = conditions.dropout;
  options.plant.steering_dead_time = conditions.steering_dead_time;
  options.plant.actuation.speed_gain = conditions.speed_gain;
  options.car.acceleration_max = conditions.acceleration_max;
}

std::optional<vehicle::Odometry> HardwareModel::sense(const sim::Observation& seen,
                                                      const sim::CarState& state) {
  const vehicle::LocaliserOutput& out = localiser_.update({seen.scan, wheels_.pose(), seen.time});
  record_.update_ms.push_back(static_cast<float>(1e3 * out.update_time));
  if (out.status == vehicle::LocaliserStatus::ok) known_at_ = seen.time;
  if (seen.time - known_at_ > conditions_.max_blind_time) {
    ++record_.blind;
    return std::nullopt;
  }
  const maps::Pose truth = sim::rear_axle(car_, state);
  record_.error.push_back(static_cast<float>(std::hypot(out.pose.x - truth.x, out.pose.y - truth.y)));
  record_.yaw_error.push_back(static_cast<float>(std::abs(maps::wrap_angle(out.pose.yaw - truth.yaw))));
  vehicle::Odometry made{.pose = out.pose, .speed = wheels_.speed()};
  for (std::size_t i = 0; i < made.covariance.size(); ++i)
    std::copy(std::begin(out.covariance[i]), std::end(out.covariance[i]), made.covariance[i].begin());
  return made;
}

std::optional<ImuReading> HardwareModel::read_imu() noexcept {
  if (!conditions_.imu) return std::nullopt;
  return imu_.read();
}

Command HardwareModel::servo(const Command& command, double time_step) noexcept {
  const double target = conditions_.steering_gain * command.steer + conditions_.steering_offset;
  const double lag = conditions_.steering_time_constant;
  steer_ += (target - steer_) * (lag > 0 ? 1 - std::exp(-time_step / lag) : 1);
  return {steer_, command.speed};
}

}  // namespace slalom::evaluation
