#include "slalom/evaluation/lap_settings.hpp"

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

std::optional<HardwareConditions> hardware_of(const LapSettings& settings) {
  if (!settings.hardware && !settings.localised) return std::nullopt;
  HardwareConditions conditions = settings.hardware
                                      ? *settings.hardware
                                      : HardwareConditions::sensors(settings.range_noise, settings.dropout);
  for (const auto& [name, text] : settings.localiser) set_option(conditions.localiser, name, text);
  return conditions;
}

bool set_world_option(LapSettings& settings, std::string_view key, std::string_view text) {
  const std::size_t point = key.find('.');
  const std::string_view section = key.substr(0, point),
                         option = key.substr(std::min(point, key.size() - 1) + 1);
  const bool of_localiser = section == "localiser";
  if (section != "world" && !of_localiser) return false;
  vehicle::LocaliserOptions localiser;
  const auto entries = of_localiser ? list_options(localiser) : list_options(settings);
  std::string rule;
  try {
    if (of_localiser ? set_option(localiser, option, text) : set_option(settings, option, text)) {
      if (of_localiser) settings.localiser.emplace_back(option, text);
      return true;
    }
    for (const OptionEntry& entry : entries)
      rule += (rule.empty() ? "" : ", ") + std::string(entry.declaration.name);
    rule = "must be one of these of the " + std::string(section) + ": " + rule;
  } catch (const std::invalid_argument& error) {
    rule = error.what();
  }
  throw std::invalid_argument("key " + std::string(key) + ": " + rule);
}

}  // namespace slalom::evaluation
