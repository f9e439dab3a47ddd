#include "evaluation/driver/car_driver.hpp"

#include "evaluation/lap_setup.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::evaluation {
namespace {

/// Pose and speed of the rear axle of the simulated car.
vehicle::Odometry odometry_of(const sim::Observation& seen, double rear_length) {
  const double c = std::cos(seen.pose.yaw), s = std::sin(seen.pose.yaw);
  return {{seen.pose.x - rear_length * c, seen.pose.y - rear_length * s, seen.pose.yaw}, seen.speed};
}

/// The mode of the tracker of a car in a world; not `automatic`.
TrackingMode tracking_of(const LapSetup& setup, const sim::World& world) {
  const LapSettings& settings = setup.settings;
  if (settings.tracking != TrackingMode::automatic) return settings.tracking;
  const bool meets = world.cars() > 1 && setup.driver.configuration.planner.predict_others &&
                     setup.environment->protocol == Protocol::true_physics;
  if (!meets) return TrackingMode::off;
  return hardware_of(settings) ? TrackingMode::localised : TrackingMode::exact;
}

}  // namespace

PlanningDriver::PlanningDriver(const LapSetup& setup, const sim::World& world, std::size_t car,
                               std::uint64_t seed, const std::string& label)
    : rules_(&rules_of(setup.environment->protocol)),
      latency_(setup.settings.latency),
      steering_gain_(setup.settings.steering_gain),
      car_(car),
      planner_(make_planner(setup)) {
  planner_.reset(solver_seed(seed, setup.driver.method + label));
  const maps::OccupancyGrid& map = setup.environment->course.map;
  if (const auto conditions = hardware_of(setup.settings))
    hardware_.emplace(*conditions, vehicle::reachable_map(setup.environment->course), world.options().car,
                      world.state(car), solver_seed(seed, "hardware" + label));
  const TrackingMode tracking = tracking_of(setup, world);
  if (tracking == TrackingMode::off) return;
  tracking_.emplace(tracking, map, world, car, solver_seed(seed, "tracking" + label));
  predictor_.emplace(path_of(setup));
}

PlannerUpdate PlanningDriver::decide(const sim::World& world) {
  PlannerUpdate update{.seen = world.observe(car_), .scan = {}, .odometry = {}};
  update.scan = rules_->scan(update.seen, world);
  if (tracking_) update.others = predictor_->update(tracking_->observe(world, update.scan), update.seen.time);
  update.odometry = odometry_of(update.seen, world.options().car.rear_length);
  if (hardware_) {
    const auto sensed = hardware_->sense(update.seen, world.state(car_));
    update.localised = sensed.has_value();
    if (sensed) update.odometry = *sensed;
  }
  // Without a pose the planner gets NaN and stops.
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  update.output = &planner_.update(
      {.scan = update.scan,
       .odometry = update.localised ? update.odometry
                                    : vehicle::Odometry{{unknown, unknown, unknown}, update.odometry.speed},
       .imu = hardware_ ? hardware_->read_imu() : std::nullopt,
       .others = update.others});
  const double time_step = world.options().time_step;
  const auto delay = std::llround(latency_ / time_step) +
                     saturate_cast<long long>(std::ceil(extra_latency_ / time_step - 1e-9));
  pending_.emplace_back(world.steps() + delay, rules_->command(update.output->command));
  return update;
}

Command PlanningDriver::command(const sim::World& world) {
  while (!pending_.empty() && pending_.front().first <= world.steps()) {
    applied_ = pending_.front().second;
    pending_.erase(pending_.begin());
  }
  Command command = hardware_ ? hardware_->servo(applied_, world.options().time_step) : applied_;
  command.steer *= steering_gain_;
  return command;
}

void PlanningDriver::moved(const sim::World& world) noexcept {
  if (hardware_) hardware_->moved(world.state(car_), world.options().time_step);
  if (tracking_) tracking_->moved(world.state(car_), world.options().time_step);
}

PlannerUpdate CarDriver::decide(const sim::World& world) {
  if (!world.on_track(car_)) return {};
  if (auto* planning = std::get_if<PlanningDriver>(&law_)) return planning->decide(world);
  if (auto* racer = std::get_if<sim::RacingOpponent>(&law_)) decided_ = racer->command(world);
  return {};
}

Command CarDriver::command(const sim::World& world) {
  if (!world.on_track(car_)) return {};
  if (auto* planning = std::get_if<PlanningDriver>(&law_)) return planning->command(world);
  if (std::holds_alternative<sim::RacingOpponent>(law_)) return decided_;
  const sim::CarState& car = world.state(car_);
  return std::get<sim::PurePursuit>(law_).command({car.x, car.y, car.yaw});
}

void CarDriver::moved(const sim::World& world) noexcept {
  if (auto* planning = std::get_if<PlanningDriver>(&law_); planning && world.on_track(car_))
    planning->moved(world);
}

}  // namespace slalom::evaluation
