#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "slalom/core/options.hpp"
#include "slalom/evaluation/hardware.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::evaluation {

/// What a lap is besides course, configuration and method.
struct LapSettings {
  int obstacles = 0;                             ///< parked cars, 0 ... 1000
  std::optional<maps::Pose> start{};             ///< of the centre of gravity; else the environment's
  int threads = 1;                               ///< of the solver; the result does not depend on it
  std::optional<HardwareConditions> hardware{};  ///< as on a real car, "true" evaluation only
  std::optional<std::uint64_t> layout{};         ///< the seed of the obstacles' places; else the lap's
  bool additional_costs = false;  ///< also `published_model_cost` and `driven_cost`, which take time

  // What makes a world harder than the usual one, "true" evaluation only. visit_options declares them, so
  // that evaluations can sweep them by name.
  double latency = 0;             ///< s from a scan to its command's effect
  int opponents = 0;              ///< cars that drive along the course line, on loops only
  double opponent_speed = 0.5;    ///< of the line's speed
  double speed_scale = 1;         ///< of the course's speed profile
  double friction = 1.0489;       ///< between tyre and road
  bool saturating_tyres = false;  ///< grip can be exceeded: sim::Model::saturating
  double steering_gain = 1;       ///< of the wheels' angle over the commanded
  double range_noise = 0.01;      ///< m, standard deviation of each range
  double dropout = 0;             ///< share of beams without a return
};

template <class Options, class Visit>
requires is_options_of<Options, LapSettings>
void visit_options(Options& o, Visit&& visit) {
  const auto number = [&](auto& field, const char* name, const char* unit, const char* help, double min,
                          double max) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help, .min = min, .max = max});
  };
  number(o.latency, "latency", "s", "from a scan to its command's effect", 0, 1);
  number(o.opponents, "opponents", "", "cars that drive along the course line", 0, 16);
  number(o.opponent_speed, "opponent_speed", "", "of the line's speed", 0.01, 1);
  number(o.speed_scale, "speed_scale", "", "of the course's speed profile", 0.1, 3);
  number(o.friction, "friction", "", "between tyre and road", 0.1, 3);
  visit(o.saturating_tyres,
        Declaration{.name = "saturating_tyres", .unit = "", .help = "grip can be exceeded"});
  number(o.steering_gain, "steering_gain", "", "of the wheels' angle over the commanded", 0.1, 10);
  number(o.range_noise, "range_noise", "m", "of each range", 0, 1);
  number(o.dropout, "dropout", "", "share of beams without a return", 0, 1);
}

/// Sets the option of this name from text where `key` is "world." and a name: "world.friction". False if
/// it is no such key. Throws std::invalid_argument naming the key, the value and the rule it breaks.
bool set_world_option(LapSettings& settings, std::string_view key, std::string_view text);

}  // namespace slalom::evaluation
