#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "view/protocol/messages.hpp"
#include "view/session/drives.hpp"

/// Reads the commands of a page. The functions throw MalformedCommand, which names the key, where a field is
/// missing, of another type or out of range.
namespace slalom::view {

/// A malformed command, in contrast to one that cannot be executed.
struct MalformedCommand : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

namespace field {

/// Returns a finite number; `otherwise` if it is missing.
double number(const nlohmann::ordered_json& command, const char* key, std::optional<double> otherwise = {});
/// Returns an integer in [-1e9, 1e9]; `otherwise` if it is missing.
int integer(const nlohmann::ordered_json& command, const char* key, std::optional<int> otherwise = {});
std::string text(const nlohmann::ordered_json& command, const char* key);
bool flag(const nlohmann::ordered_json& command, const char* key);

}  // namespace field

/// Returns the action of the commands add, move, remove, place_car and nudge; empty for others. `car`:
/// present state of the car.
Action edit_of(const std::string& what, const nlohmann::ordered_json& command, const sim::CarState& car);

/// Applies the settings `set` of a command, a list of key=value. Returns false if there are none.
bool apply_settings(vehicle::Configuration& configuration, const nlohmann::ordered_json& command,
                    const std::string& method);

/// Returns the scenario that the command scenario chooses; only the listed courses and configurations are
/// allowed.
ScenarioNames chosen_scenario(ScenarioNames present, const nlohmann::ordered_json& command,
                              const Choices& choices);

}  // namespace slalom::view
