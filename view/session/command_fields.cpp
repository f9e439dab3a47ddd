#include "view/session/command_fields.hpp"

#include <cmath>

#include "src/evaluation/json.hpp"

namespace slalom::view::field {

double number(const Json& command, const char* key) {
  const auto found = command.find(key);
  if (found == command.end() || !found->is_number() || !std::isfinite(found->get<double>()))
    throw MalformedCommand(std::string(key) + ": must be a finite number");
  return found->get<double>();
}

double number(const Json& command, const char* key, double otherwise) {
  return command.contains(key) ? number(command, key) : otherwise;
}

int integer(const Json& command, const char* key) {
  const double value = number(command, key);
  if (std::floor(value) != value || std::abs(value) > 1e9)
    throw MalformedCommand(std::string(key) + ": must be an integer");
  return static_cast<int>(value);
}

std::string text(const Json& command, const char* key) {
  const auto found = command.find(key);
  if (found == command.end() || !found->is_string())
    throw MalformedCommand(std::string(key) + ": must be text");
  return found->get<std::string>();
}

bool flag(const Json& command, const char* key) {
  const auto found = command.find(key);
  if (found == command.end() || !found->is_boolean())
    throw MalformedCommand(std::string(key) + ": must be true or false");
  return found->get<bool>();
}

maps::Pose pose(const Json& command) {
  return {number(command, "x"), number(command, "y"), number(command, "yaw", 0)};
}

}  // namespace slalom::view::field
