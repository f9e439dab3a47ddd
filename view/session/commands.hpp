#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "view/protocol/messages.hpp"
#include "view/server/audience.hpp"
#include "view/session/drives.hpp"

/// Reads the commands of a page that drives a car. The functions throw MalformedCommand, which names the key,
/// where a field is missing, of another type or out of range.
namespace slalom::view {

/// Returns the action of the commands add, move, remove, place_car and nudge; empty for others. `car`:
/// present state of the car.
Action edit_of(const std::string& what, const nlohmann::ordered_json& command, const sim::CarState& car);

/// Sets an option as vehicle::set_option does. Throws std::invalid_argument, too, for more samples than a
/// page can wait for.
void set_page_option(vehicle::Configuration& configuration, const std::string& key, const std::string& value,
                     const std::string& method);

/// Applies the settings `set` of a command, a list of key=value. Returns false if there are none.
bool apply_settings(vehicle::Configuration& configuration, const nlohmann::ordered_json& command,
                    const std::string& method);

/// Returns the scenario that the command scenario chooses; only the listed courses and configurations are
/// allowed.
ScenarioNames chosen_scenario(ScenarioNames present, const nlohmann::ordered_json& command,
                              const Choices& choices);

}  // namespace slalom::view
