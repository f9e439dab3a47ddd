#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "json/json.hpp"
#include "view/session/session.hpp"

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

/// Returns the action of the commands add, move, remove, place_car and nudge; empty for others.
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

/// Sets an option as vehicle::set_option does. Throws std::invalid_argument, too, for more samples than a
/// page can wait for.
void set_page_option(vehicle::Configuration& configuration, const std::string& key, const std::string& value,
                     const std::string& method) {
  vehicle::set_option(configuration, key, value, method);
  if (!key.ends_with("samples") && !key.ends_with("horizon")) return;
  for (const SolverOptions& each : configuration.methods) field::check_samples(each);
}

/// Applies the settings `set` of a command, a list of key=value. Returns false if there are none.
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

/// Returns the scenario that the command scenario chooses; only listed courses and configurations are
/// allowed.
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

bool is_among(std::initializer_list<std::string_view> names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

void Session::obey(std::uint64_t client, const std::string& what, const Json& command) {
  if (what == "save") return save(client, field::text(command, "what"));
  if (!obey_transport(client, what, command) && !obey_edit(what, command) && !obey_scenario(what, command) &&
      !obey_options(what, command))
    throw MalformedCommand("do: '" + what.substr(0, 40) + "' is not a command");
  // Another scenario or another rate ends the introduction.
  const bool is_other = is_among({"scenario", "method", "fork", "ghost", "set", "reset_options"}, what);
  if (!state_.introduction || !(is_other || is_among({"rate", "real_time"}, what))) return;
  state_.introduction = false;
  if (is_other) rate_ = 1;
}

bool Session::obey_edit(const std::string& what, const Json& command) {
  const bool is_of_car = what == "nudge" || what == "place_car";
  const sim::CarState car = is_of_car ? present().world().state(0) : sim::CarState{};
  const Action action = edit_of(what, command, car);
  if (!action) return false;
  const int drag = field::integer(command, "drag", 0), lead = is_of_car ? 0 : scan_lead;
  std::vector<Body> before = bodies_of(present(lead).world());
  perform({action}, lead);
  if (!is_of_car) remember(std::move(before), drag);
  return true;
}

bool Session::obey_scenario(const std::string& what, const Json& command) {
  if (what == "real_time") {
    state_.real_time = field::flag(command, "on");
    if (state_.real_time) rate_ = 1;
  } else if (what == "scenario") {
    ScenarioNames present = state_.names;
    present.method = driver().method;
    const ScenarioNames names = chosen_scenario(present, command, options_.choices);
    install(options_.load(names), names);
    paused_ = false;
  } else {
    return false;
  }
  return true;
}

bool Session::obey_options(const std::string& what, const Json& command) {
  const vehicle::Configuration before = present().car.setup().driver.configuration;
  const std::string method = present().car.setup().driver.method;
  const auto change_options = [&](const vehicle::Configuration& changed) {
    change_driver(changed, method);
    remember(before);
  };
  if (what == "set") {
    vehicle::Configuration changed = before;
    set_page_option(changed, field::text(command, "key"), field::text(command, "value"), method);
    change_options(changed);
  } else if (what == "reset_options") {
    change_options(loaded_);
  } else if (what == "method") {
    change_driver(before, field::text(command, "method"));
  } else if (what == "undo" || what == "redo") {
    undo(what == "redo");
  } else if (what == "fork") {
    fork(command);
  } else if (what == "ghost") {
    set_ghost(field::text(command, "method"));
  } else {
    return false;
  }
  return true;
}

/// Lets another configuration or method drive. With another control period the drive begins anew.
void Session::change_driver(const vehicle::Configuration& configuration, const std::string& method) {
  evaluation::LapSetup changed = setup();
  changed.driver = {configuration, method};
  if (changed.control_period() == control_period())
    perform({view::change_driver(changed.driver)});
  else {
    begin({evaluation::LapDrive(changed, state_.names.seed)});
    if (paused_) tick();
  }
}

/// Takes the last change back, or with `again` the last undo.
void Session::undo(bool again) {
  auto &from = again ? redo_ : undo_, &to = again ? undo_ : redo_;
  if (from.empty()) throw std::invalid_argument(again ? "nothing to redo" : "nothing to undo");
  continue_from_shown();
  if (from.empty()) return;  // going back has undone it
  const Change last = from.back();
  Change replaced{last.ticks, driver().configuration};
  if (const auto* bodies = std::get_if<1>(&last.before)) {
    replaced.before = bodies_of(present(scan_lead).world());
    perform({set_bodies(*bodies)}, scan_lead);
  } else {
    change_driver(std::get<0>(last.before), driver().method);
  }
  from.pop_back();
  replaced.ticks = acted_;
  to.push_back(std::move(replaced));
  drag_ = 0;
}

/// Continues with another method or other options; the present driver continues as a ghost.
void Session::fork(const Json& command) {
  evaluation::LapSetup changed = present().car.setup();
  const std::string method = field::text(command, "method"), before = changed.driver.method;
  const vehicle::Configuration replaced = changed.driver.configuration;
  changed.driver.method = method;
  const bool has_settings = apply_settings(changed.driver.configuration, command, method);
  if (changed.control_period() != control_period())
    throw std::invalid_argument("fork: the control period cannot change during a drive");
  perform(
      {start_ghost(before == method ? before + " as before" : before), view::change_driver(changed.driver)});
  if (has_settings) remember(replaced);
}

/// Starts a ghost with a method as a copy of the car; without one, ends the ghost.
void Session::set_ghost(const std::string& method) {
  if (method.empty()) return perform({end_ghost});
  std::optional<evaluation::Driver> other;
  if (method != driver().method) other = {driver().configuration, method};
  perform({start_ghost(method, std::move(other))});
}

}  // namespace slalom::view
