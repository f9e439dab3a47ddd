#include "view/session/commands.hpp"

#include <algorithm>
#include <cmath>

#include "src/evaluation/json.hpp"

namespace slalom::view {
namespace {

maps::Pose pose_of(const Json& command) {
  return {field::number(command, "x"), field::number(command, "y"), field::number(command, "yaw", 0)};
}

Action addition(const Json& command) {
  Body body{.pose = pose_of(command)};
  const std::string kind = field::text(command, "kind");
  field::require(kind == "car" || kind == "box" || kind == "disc", "kind", "car, box or disc");
  body.is_disc = kind == "disc";
  body.length = field::number(command, "length", body.length);
  body.width = field::number(command, "width", body.length);
  const double least = std::min(body.length, body.width), most = std::max(body.length, body.width);
  field::require(least >= 0.02 && most <= 10, "length and width", "in [0.02, 10] m");
  return kind == "car" ? add_parked_car(body.pose) : add_body(body);
}

std::uint64_t seed_of(const std::string& digits) {
  const bool is_number = digits.find_first_not_of("0123456789") == std::string::npos;
  field::require(!digits.empty() && digits.size() <= 19 && is_number, "seed", "a whole number from 0");
  return std::stoull(digits);
}

int count_of(const Json& command, const char* key, int present, int most) {
  const int count = field::integer(command, key, present);
  field::require(count >= 0 && count <= most, key, ("in [0, " + std::to_string(most) + "]").c_str());
  return count;
}

}  // namespace

Action edit_of(const std::string& what, const Json& command, const sim::CarState& car) {
  if (what == "add") return addition(command);
  if (what == "move") return move_body(field::integer(command, "body"), pose_of(command));
  if (what == "remove") return remove_body(field::integer(command, "body"));
  if (what == "place_car") return move_car(pose_of(command));
  if (what != "nudge") return {};
  const double aside = field::number(command, "left", 0), turn = field::number(command, "turn", 0);
  field::require(std::abs(aside) <= 2 && std::abs(turn) <= 3.2, "nudge", "at most 2 m and 3.2 rad");
  return move_car({car.x - aside * std::sin(car.yaw), car.y + aside * std::cos(car.yaw), car.yaw + turn});
}

void set_page_option(vehicle::Configuration& configuration, const std::string& key, const std::string& value,
                     const std::string& method) {
  vehicle::set_option(configuration, key, value, method);
  if (!key.ends_with("samples") && !key.ends_with("horizon")) return;
  for (const SolverOptions& each : configuration.methods) field::check_samples(each);
}

bool apply_settings(vehicle::Configuration& configuration, const Json& command, const std::string& method) {
  const Json set = command.contains("set") ? command.at("set") : Json::array();
  field::require(set.is_array() && set.size() <= 200, "set", "a list of at most 200 key=value");
  for (const Json& each : set) {
    const std::string assignment = each.is_string() ? each.get<std::string>() : "";
    const auto equals = assignment.find('=');
    field::require(equals != std::string::npos, "set", "a list of key=value");
    set_page_option(configuration, assignment.substr(0, equals), assignment.substr(equals + 1), method);
  }
  return !set.empty();
}

ScenarioNames chosen_scenario(ScenarioNames names, const Json& command, const Choices& choices) {
  const auto choose = [&](const char* key, std::string& name, const std::vector<std::string>& all) {
    if (!command.contains(key)) return;
    const std::string wanted = field::text(command, key);
    // A page must not make the server read other folders than those that are listed or already open.
    if (wanted != name && std::ranges::find(all, wanted) == all.end())
      throw std::invalid_argument(std::string(key) + ": '" + wanted + "' is unknown");
    name = wanted;
  };
  choose("course", names.course, choices.courses);
  choose("config", names.config, choices.configurations);
  if (command.contains("method")) names.method = field::text(command, "method");
  if (command.contains("seed")) names.seed = seed_of(field::text(command, "seed"));
  names.obstacles = count_of(command, "obstacles", names.obstacles, 60);
  names.opponents = count_of(command, "opponents", names.opponents, 16);
  return names;
}

}  // namespace slalom::view
