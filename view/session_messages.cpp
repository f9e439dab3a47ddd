#include <cmath>
#include <nlohmann/json.hpp>

#include "session.hpp"
#include "slalom/core/option_access.hpp"

namespace slalom::view {
namespace {

using Json = nlohmann::ordered_json;

Message text_message(const Json& json) {
  return {std::make_shared<const std::string>(json.dump(-1, ' ', false, Json::error_handler_t::replace)),
          false};
}

/// A lap's seed and the program's threads take their place.
bool is_shown(const std::string& section, const std::string& option, const std::string& method) {
  if (section == "vehicle" || section == "planner") return true;
  return section == method && option != "seed" && option != "threads";
}

Json option_json(const OptionEntry& entry, const OptionEntry& loaded) {
  const Declaration& d = entry.declaration;
  Json json = {{"name", d.name},
               {"symbol", d.symbol},
               {"unit", d.unit},
               {"help", d.help},
               {"type", type_name(entry)},
               {"value", to_text(entry.value)},
               {"default", to_text(loaded.value)}};
  if (std::isfinite(d.min)) json["min"] = d.min;
  if (std::isfinite(d.max)) json["max"] = d.max;
  if (!entry.choices.empty()) json["choices"] = entry.choices;
  return json;
}

}  // namespace

void Session::greet(std::uint64_t client) {
  server_.send(client, {std::make_shared<const std::string>(hello_message()), false});
  server_.send(client, {scene_, true});
  server_.send(client, {std::make_shared<const std::string>(options_message()), false});
  server_.send(client, {std::make_shared<const std::string>(state_message()), false});
  if (waiting_) {
    waiting_ = false;
    due_ = Clock::now();
  }
  if (!history_.empty()) {
    const auto at =
        viewed_ >= 0 ? static_cast<std::size_t>(viewed_ - history_.front().tick) : history_.size() - 1;
    server_.send(client, {history_[at].frame, true});
  }
  state_changed_ = true;
}

void Session::refuse(std::uint64_t client, const std::string& why) {
  server_.send(client, text_message({{"type", "error"}, {"message", why}}));
}

void Session::tell_state() {
  state_changed_ = false;
  server_.broadcast({std::make_shared<const std::string>(state_message()), false});
}

void Session::tell_options() {
  server_.broadcast({std::make_shared<const std::string>(options_message()), false});
}

std::string Session::hello_message() const {
  const sim::WorldOptions world = scenario_.arena->world_options();
  Json names = Json::array(), statuses = Json::array();
  for (const char* each : scalar_names()) names.push_back(each);
  for (int i = 0; i <= static_cast<int>(vehicle::PlannerStatus::solver_degenerate); ++i)
    statuses.push_back(vehicle::name(static_cast<vehicle::PlannerStatus>(i)));
  const sim::CarParameters& car = world.car;
  const Json hello = {{"type", "hello"},
                      {"protocol", 1},
                      {"scalars", names},
                      {"statuses", statuses},
                      {"courses", options_.courses},
                      {"methods", options_.methods},
                      {"configurations", options_.configurations},
                      {"car",
                       {{"length", car.length},
                        {"width", car.width},
                        {"front", car.front_length},
                        {"rear", car.rear_length}}},
                      {"lidar",
                       {{"angle_min", world.lidar.angle_min()},
                        {"angle_increment", world.lidar.angle_increment()},
                        {"range_max", world.lidar.range_max}}},
                      {"history_seconds", options_.history},
                      {"control_period", simulation_->ride().runner().control_period()}};
  return hello.dump();
}

std::string Session::state_message() const {
  Json laps = Json::array();
  for (const Lap& lap : laps_)
    laps.push_back(
        {{"lap", lap.lap}, {"time", lap.time}, {"contacts", lap.contacts}, {"method", lap.method}});
  const evaluation::Arena& arena = *scenario_.arena;
  const int newest = history_.empty() ? -1 : history_.back().tick;
  const Json state = {{"type", "state"},
                      {"course", names_.course},
                      {"description", arena.course.description},
                      {"length", arena.course.length},
                      {"method", names_.method},
                      {"config", names_.config},
                      {"evaluation", evaluation::name(arena.evaluation)},
                      {"seed", std::to_string(names_.seed)},
                      {"obstacles", names_.obstacles},
                      {"paused", paused_},
                      {"real_time", real_time_},
                      {"rate", rate_},
                      {"tick", viewed_ >= 0 ? viewed_ : newest},
                      {"newest", newest},
                      {"oldest", history_.empty() ? -1 : history_.front().tick},
                      {"time", simulation_->ride().world().time()},
                      {"control_period", simulation_->ride().runner().control_period()},
                      {"laps", laps},
                      {"ghost", ghost_method_},
                      {"generation", generation_},
                      {"clients", server_.clients()},
                      {"refused", refused_},
                      {"edited", simulation_->edited()}};
  return state.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string Session::options_message() const {
  Json sections = Json::array();
  const auto now = vehicle::list_sections(configuration_),
             loaded = vehicle::list_sections(scenario_.configuration);
  for (std::size_t i = 0; i < now.size(); ++i) {
    Json options = Json::array();
    for (std::size_t k = 0; k < now[i].options.size(); ++k) {
      const OptionEntry& entry = now[i].options[k];
      if (is_shown(now[i].name, entry.declaration.name, names_.method))
        options.push_back(option_json(entry, loaded[i].options[k]));
    }
    if (options.empty()) continue;
    const Json section = {{"name", now[i].name}, {"options", options}};
    // The method's own options come first: they are what one wants to turn.
    if (now[i].name == names_.method)
      sections.insert(sections.begin(), section);
    else
      sections.push_back(section);
  }
  const Json message = {{"type", "options"},
                        {"sections", sections},
                        {"changed", changed_options()},
                        {"command_line", command_line()},
                        {"yaml", changed_yaml()},
                        {"undo", undo_.size()},
                        {"redo", redo_.size()}};
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// "section.option=value" of all that differs from the configuration that was loaded.
std::vector<std::string> Session::changed_options() const {
  std::vector<std::string> changed;
  const auto now = vehicle::list_sections(configuration_),
             loaded = vehicle::list_sections(scenario_.configuration);
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t k = 0; k < now[i].options.size(); ++k)
      if (!(now[i].options[k] == loaded[i].options[k]))
        changed.push_back(now[i].name + "." + now[i].options[k].declaration.name + "=" +
                          to_text(now[i].options[k].value));
  return changed;
}

std::string Session::command_line() const {
  std::string line = "slalom drive --course " + names_.course + " --method " + names_.method + " --config " +
                     names_.config + " --seed " + std::to_string(names_.seed) + " --obstacles " +
                     std::to_string(names_.obstacles) + options_.further_arguments;
  for (const std::string& each : changed_options()) line += " --set '" + each + "'";
  return line;
}

std::string Session::changed_yaml() const {
  std::string yaml = "base: " + names_.config + "\n", section;
  for (const std::string& each : changed_options()) {
    const auto dot = each.find('.'), equals = each.find('=');
    if (each.substr(0, dot) != section) {
      section = each.substr(0, dot);
      yaml += section + ":\n";
    }
    yaml += "  " + each.substr(dot + 1, equals - dot - 1) + ": " + each.substr(equals + 1) + "\n";
  }
  return yaml;
}

}  // namespace slalom::view
