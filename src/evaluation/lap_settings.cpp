#include "slalom/evaluation/lap_settings.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "slalom/core/option_access.hpp"

namespace slalom::evaluation {

sim::CarParameters car_of(const LapSettings& settings, const vehicle::Configuration& configuration) {
  sim::CarParameters car;
  if (settings.car == CarKind::passenger_car) car = sim::CarParameters::full_scale();
  if (settings.car == CarKind::configured) {
    const vehicle::VehicleOptions& vehicle = configuration.vehicle;
    const auto& own = vehicle.own_of<vehicle::SingleTrackOptions>();
    car.cornering_front = own.cornering_front;
    car.cornering_rear = own.cornering_rear;
    car.front_length = vehicle.front_length;
    car.rear_length = vehicle.rear_length;
    car.gravity_height = own.gravity_height;
    car.mass = own.mass;
    car.inertia = own.inertia;
    car.steer_max = configuration.planner.steer_limit;
    car.steer_min = -car.steer_max;
    car.steer_rate_max = own.steer_rate;
    car.switch_speed = own.switch_speed;
    car.acceleration_max = std::max(vehicle.max_acceleration, vehicle.max_deceleration);
    car.length = vehicle.body.front + vehicle.body.rear;
    car.width = vehicle.body.width;
  }
  car.friction = settings.friction;
  return car;
}

bool has_planner(const LapSettings& settings, int index) noexcept {
  const int first = settings.blocking_opponents + settings.erratic_opponents;
  return index >= first && index < first + settings.planning_opponents;
}

std::optional<HardwareConditions> hardware_of(const LapSettings& settings) {
  if (settings.hardware || !settings.localised) return settings.hardware;
  return HardwareConditions::sensors(settings.range_noise, settings.dropout);
}

sim::OpponentDriver driver_of(const LapSettings& settings, int index) noexcept {
  if (index < settings.blocking_opponents) return sim::OpponentDriver::blocking;
  if (index < settings.blocking_opponents + settings.erratic_opponents) return sim::OpponentDriver::erratic;
  return settings.opponent_driver;
}

bool set_world_option(LapSettings& settings, std::string_view key, std::string_view text) {
  constexpr std::string_view section = "world.";
  if (key.substr(0, section.size()) != section) return false;
  const std::string_view option = key.substr(section.size());
  std::string rule;
  try {
    if (set_option(settings, option, text)) return true;
    for (const OptionEntry& entry : list_options(settings))
      rule += (rule.empty() ? "" : ", ") + std::string(entry.declaration.name);
    rule = "must be one of these of the world: " + rule;
  } catch (const std::invalid_argument& error) {
    rule = error.what();
  }
  throw std::invalid_argument("key " + std::string(key) + ": " + rule);
}

}  // namespace slalom::evaluation
