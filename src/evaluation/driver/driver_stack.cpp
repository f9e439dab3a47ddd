#include "evaluation/driver/driver_stack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "evaluation/lap_rules.hpp"

namespace slalom::evaluation {
namespace {

/// Pose and speed of the rear axle of the simulated car.
vehicle::Odometry odometry_of(const sim::Observation& seen, double rear_length) {
  const double c = std::cos(seen.pose.yaw), s = std::sin(seen.pose.yaw);
  return {{seen.pose.x - rear_length * c, seen.pose.y - rear_length * s, seen.pose.yaw}, seen.speed};
}

}  // namespace

sim::WorldOptions DriverStack::world_options(const LapRunner& runner) {
  sim::WorldOptions options = runner.environment().world_options();
  rules_of(runner.environment().protocol).configure(options, runner.settings(), runner.configuration());
  if (runner.settings().hardware) HardwareModel::apply(*runner.settings().hardware, options);
  return options;
}

long long DriverStack::steps_per_command(const LapRunner& runner, const sim::World& world) noexcept {
  return std::max<long long>(1, std::llround(runner.control_period() / world.options().time_step));
}

DriverStack::DriverStack(const LapRunner& runner, const sim::World& world, std::size_t car,
                         std::uint64_t seed, const std::string& label)
    : runner_(&runner), car_(car), planner_(runner.make_planner()) {
  planner_->reset(solver_seed(seed, runner.method() + label));
  const LapSettings& settings = runner.settings();
  const maps::OccupancyGrid& map = runner.environment().course.map;
  if (settings.hardware)
    hardware_ = std::make_unique<HardwareModel>(*settings.hardware, map, world.options().car,
                                                world.state(car), solver_seed(seed, "hardware" + label));
  if (settings.tracking == TrackingMode::off) return;
  tracking_ = std::make_unique<TrackingMeter>(settings.tracking, map, world, car,
                                              solver_seed(seed, "tracking" + label));
  predictor_.emplace(runner.path_);
}

DriverStack::Update DriverStack::update(const sim::World& world) {
  const sim::Observation seen = world.observe(car_);
  const maps::LaserScanView scan = rules_of(runner_->environment().protocol).scan(seen, world);
  std::span<const maps::PredictedObstacle> others;
  if (tracking_) others = predictor_->update(tracking_->observe(world, scan), seen.time);
  vehicle::Odometry odometry = odometry_of(seen, world.options().car.rear_length);
  bool localised = true;
  if (hardware_) {
    const auto sensed = hardware_->sense(seen, world.state(car_));
    localised = sensed.has_value();
    if (localised) odometry = *sensed;
  }
  // Without a pose the planner gets NaN and stops.
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const vehicle::PlannerOutput& output = planner_->update(
      {.scan = scan,
       .odometry = localised ? odometry : vehicle::Odometry{{unknown, unknown, unknown}, odometry.speed},
       .imu = hardware_ ? hardware_->read_imu() : std::nullopt,
       .others = others});
  return {seen, scan, odometry, localised, output, others};
}

void DriverStack::send(const Command& command, const sim::World& world, double extra_latency) {
  const double time_step = world.options().time_step;
  const auto delay = std::llround(runner_->settings().latency / time_step) +
                     static_cast<long long>(std::ceil(extra_latency / time_step - 1e-9));
  pending_.emplace_back(world.steps() + delay, rules_of(runner_->environment().protocol).command(command));
}

Command DriverStack::command(const sim::World& world) {
  while (!pending_.empty() && pending_.front().first <= world.steps()) {
    applied_ = pending_.front().second;
    pending_.erase(pending_.begin());
  }
  Command command = hardware_ ? hardware_->servo(applied_, world.options().time_step) : applied_;
  command.steer *= runner_->settings().steering_gain;
  return command;
}

void DriverStack::moved(const sim::World& world) noexcept {
  if (hardware_) hardware_->moved(world.state(car_), world.options().time_step);
  if (tracking_) tracking_->moved(world.state(car_), world.options().time_step);
}

}  // namespace slalom::evaluation
