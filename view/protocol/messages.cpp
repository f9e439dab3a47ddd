#include "view/protocol/messages.hpp"

#include <algorithm>
#include <cmath>

#include "json/json.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/page_json.hpp"

namespace slalom::view {
namespace {

/// A lap's seed and the program's threads take their place.
bool is_shown(const std::string& section, const std::string& option, const std::string& method) {
  if (section == "vehicle" || section == "planner") return true;
  return section == method && option != "seed" && option != "threads";
}

/// "section.option=value" of all that differs from the configuration that was loaded.
std::vector<std::string> changed_options(const OptionsFacts& facts) {
  std::vector<std::string> changed;
  const auto now = vehicle::list_sections(facts.now), loaded = vehicle::list_sections(facts.loaded);
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t k = 0; k < now[i].options.size(); ++k)
      if (!(now[i].options[k] == loaded[i].options[k]))
        changed.push_back(now[i].name + "." + now[i].options[k].declaration.name + "=" +
                          to_text(now[i].options[k].value));
  return changed;
}

std::string changed_yaml(const OptionsFacts& facts, const std::vector<std::string>& changed) {
  std::string yaml = "base: " + facts.names.config + "\n", section;
  for (const std::string& each : changed) {
    const auto dot = each.find('.'), equals = each.find('=');
    if (each.substr(0, dot) != section) {
      section = each.substr(0, dot);
      yaml += section + ":\n";
    }
    yaml += "  " + each.substr(dot + 1, equals - dot - 1) + ": " + each.substr(equals + 1) + "\n";
  }
  return yaml;
}

}  // namespace

int Choices::method_index(const std::string& method) const {
  return static_cast<int>(std::ranges::find(methods, method) - methods.begin());
}

std::string command_line(const OptionsFacts& facts) {
  const ScenarioNames& names = facts.names;
  std::string line = "slalom drive --course " + names.course + " --method " + names.method + " --config " +
                     names.config + " --seed " + std::to_string(names.seed) + " --obstacles " +
                     std::to_string(names.obstacles) +
                     (names.opponents > 0 ? " --opponents " + std::to_string(names.opponents) : "") +
                     facts.further_arguments;
  for (const std::string& each : changed_options(facts)) line += " --set '" + each + "'";
  return line;
}

std::string hello_message(const evaluation::Environment& environment, const Choices& choices, double history,
                          double control_period) {
  const sim::WorldOptions world = environment.world_options();
  const sim::CarParameters& car = world.car;
  return json_text({{"type", "hello"},
                    {"protocol", 2},
                    {"title", environment.course.name},
                    {"scalars", scalar_names()},
                    {"statuses", names_json(vehicle::PlannerStatus::solver_degenerate)},
                    {"symptoms", symptoms_json()},
                    {"courses", choices.courses},
                    {"methods", choices.methods},
                    {"configurations", choices.configurations},
                    {"terms", {"distance", "yaw", "collision"}},
                    {"states", Json::array()},
                    {"inputs", {"steering, rad", "acceleration, m/s^2"}},
                    {"body", body_json(car.length, car.width, car.front_length, car.rear_length)},
                    {"can", {"place", "move", "add", "scenario", "real_time", "save", "ghost", "undo"}},
                    {"lidar",
                     {{"angle_min", world.lidar.angle_min()},
                      {"angle_increment", world.lidar.angle_increment()},
                      {"range_max", world.lidar.range_max}}},
                    {"history_seconds", history},
                    {"control_period", control_period}});
}

/// Around the line of a course.
Bounds bounds_of(const evaluation::Environment& environment) {
  constexpr double room = 1.5;  // m beside the line
  const auto& path = environment.path;
  Bounds b{path[0].x, path[0].y, path[0].x, path[0].y};
  for (const maps::ReferencePoint& p : path) b.include(p.x, p.y);
  return {b.x0 - room, b.y0 - room, b.x1 + room, b.y1 + room};
}

std::string state_message(const DriveState& facts, const evaluation::Environment& environment,
                          double control_period) {
  Json laps = Json::array();
  for (const LapNote& lap : facts.laps)
    laps.push_back({{"lap", lap.lap},
                    {"time", lap.time},
                    {"contacts", lap.contacts},
                    {"method", lap.method},
                    {"ghost", lap.ghost}});
  const ScenarioNames& names = facts.names;
  Json state = {{"type", "state"},
                {"course", names.course},
                {"description", environment.course.description},
                {"length", environment.course.length},
                {"method", names.method},
                {"config", names.config},
                {"evaluation", evaluation::name(environment.protocol)},
                {"seed", std::to_string(names.seed)},
                {"obstacles", names.obstacles},
                {"opponents", names.opponents},
                {"paused", facts.paused},
                {"real_time", facts.real_time},
                {"rate", facts.rate},
                {"pace", facts.pace},
                {"tick", facts.tick},
                {"newest", facts.newest},
                {"oldest", facts.oldest},
                {"time", facts.time},
                {"control_period", control_period},
                {"laps", laps},
                {"ghost", facts.ghost},
                {"ghost_label", facts.ghost_label},
                {"generation", facts.generation},
                {"edited", facts.edited},
                {"introduction", facts.introduction},
                {"bounds", bounds_json(bounds_of(environment))}};
  return json_text(state);
}

std::string options_message(const OptionsFacts& facts) {
  std::vector<Json> sections;
  const auto now = vehicle::list_sections(facts.now), loaded = vehicle::list_sections(facts.loaded);
  for (std::size_t i = 0; i < now.size(); ++i) {
    Json options = Json::array();
    for (std::size_t k = 0; k < now[i].options.size(); ++k) {
      const OptionEntry& entry = now[i].options[k];
      if (is_shown(now[i].name, entry.declaration.name, facts.names.method))
        options.push_back(option_json(entry, to_text(loaded[i].options[k].value)));
    }
    if (options.empty()) continue;
    // The method's own options come first: they are changed most often.
    const auto place = now[i].name == facts.names.method ? sections.begin() : sections.end();
    sections.insert(place, Json{{"name", now[i].name}, {"options", options}});
  }
  const auto changed = changed_options(facts);
  return json_text({{"type", "options"},
                    {"sections", sections},
                    {"changed", changed},
                    {"command_line", command_line(facts)},
                    {"yaml", changed_yaml(facts, changed)},
                    {"undo", facts.undo},
                    {"redo", facts.redo}});
}

}  // namespace slalom::view
