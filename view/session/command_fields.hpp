#pragma once

#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>

#include "slalom/maps/pose.hpp"

namespace slalom::view {

/// A malformed command, in contrast to one that cannot be executed.
struct MalformedCommand : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Fields of a client's command. They throw MalformedCommand, which names the key, where a field is missing
/// or of another type.
namespace field {

/// A finite number.
double number(const nlohmann::ordered_json& command, const char* key);
/// The same, or `otherwise` where the field is missing.
double number(const nlohmann::ordered_json& command, const char* key, double otherwise);
/// A whole number in [-1e9, 1e9].
int integer(const nlohmann::ordered_json& command, const char* key);
std::string text(const nlohmann::ordered_json& command, const char* key);
bool flag(const nlohmann::ordered_json& command, const char* key);
/// The fields x and y in m and, in rad, yaw, which is 0 where it is missing.
maps::Pose pose(const nlohmann::ordered_json& command);

}  // namespace field
}  // namespace slalom::view
