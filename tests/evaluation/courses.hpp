#pragma once

#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::evaluation {

/// A course of the repository.
inline std::shared_ptr<const Environment> course(const std::string& name,
                                                 Protocol protocol = Protocol::true_physics) {
  return load_environment(std::filesystem::path(SLALOM_COURSES) / name, protocol, {SLALOM_COURSES});
}

/// A course with laps that end after this time (s).
inline std::shared_ptr<const Environment> timed_out_after(
    double time, const std::shared_ptr<const Environment>& environment = course("wren")) {
  auto changed = std::make_shared<Environment>(*environment);
  changed->timeout = time;
  return changed;
}

/// A configuration of the repository; with samples above 0, for fast methods.
inline vehicle::Configuration configuration(const std::string& name, int samples = 256) {
  auto made =
      vehicle::load_configuration(std::filesystem::path(SLALOM_CONFIGS) / (name + ".yaml"), {SLALOM_CONFIGS});
  for (const char* method : {"mppi", "svg_mppi"})
    if (samples > 0) vehicle::set_option(made, std::string(method) + ".samples", std::to_string(samples));
  return made;
}

/// The default configuration with short horizons and few samples, for fast laps with mppi and svg_mppi.
inline vehicle::Configuration quick_configuration() {
  vehicle::Configuration made;
  for (const std::string method : {"mppi", "svg_mppi"})
    for (const auto& [option, value] : {std::pair("samples", "256"),
                                        {"horizon", "14"},
                                        {"variance", "0.05"},
                                        {"input_min", "-0.4"},
                                        {"input_max", "0.4"}})
      vehicle::set_option(made, option, value, method);
  return made;
}

/// A car `progress` (m) along testing::ring_track, `left` (m) of it, at a speed along it and one to its left.
inline sim::CarState on_ring(double progress, double left, double speed, double sideways = 0) {
  const double angle = progress / 5.5, radius = 5.5 - left;
  return {.x = 10 + radius * std::cos(angle),
          .y = 10 + radius * std::sin(angle),
          .speed = std::hypot(speed, sideways),
          .yaw = angle + 0.5 * std::numbers::pi,
          .slip = std::atan2(sideways, speed)};
}

}  // namespace slalom::evaluation
