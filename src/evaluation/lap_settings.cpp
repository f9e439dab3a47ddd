#include "slalom/evaluation/lap_settings.hpp"

#include <stdexcept>
#include <string>

#include "slalom/core/option_access.hpp"

namespace slalom::evaluation {

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
