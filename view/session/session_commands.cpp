#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "src/evaluation/json.hpp"
#include "view/session/commands.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

constexpr double before_contact = 2.0, after_contact = 0.25;  // s that are shown of a collision
constexpr double contact_rate = 0.25;

bool is_among(std::initializer_list<std::string_view> names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

void Session::obey(std::uint64_t client, const std::string& what, const Json& command) {
  if (what == "save") return save(client, field::text(command, "what"));
  if (obey_transport(client, what, command)) {
    if (what == "play") stop_at_ = -1;
  } else if (!obey_edit(what, command) && !obey_scenario(what, command) && !obey_options(what, command)) {
    throw MalformedCommand("do: '" + what.substr(0, 40) + "' is not a command");
  }
  // Another scenario or another rate ends the introduction.
  const bool is_other = is_among({"scenario", "method", "fork", "ghost", "set", "reset_options"}, what);
  if (!state_.introduction || !(is_other || is_among({"rate", "real_time", "lap"}, what))) return;
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
  } else if (what == "lap") {
    show_lap(command);
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

/// Shows a lap of the evaluation: from its start, or the seconds before one of its collisions.
void Session::show_lap(const Json& command) {
  if (!options_.load_lap) throw std::invalid_argument("lap: no evaluation is open");
  const int experiment = field::integer(command, "experiment"), lap = field::integer(command, "lap"),
            contact = field::integer(command, "contact", -1);
  audience_.tell(
      0, {{"type", "note"}, {"message", "Driving lap " + std::to_string(lap) + " again \xE2\x80\xA6"}});
  LoadedLap loaded = options_.load_lap(experiment, lap);
  const evaluation::Driver driver{loaded.scenario.configuration, loaded.names.method};
  Drives drives{
      evaluation::LapDrive({loaded.scenario.environment, driver, loaded.scenario.lap}, loaded.names.seed)};
  Drives before = drives;  // at the moment that is shown first
  int hit = -1;
  if (contact >= 0) {
    const double period = drives.car.setup().control_period(), timeout = drives.car.setup().timeout();
    const int lead = static_cast<int>(before_contact / period);
    Drives latest = drives;
    const auto collisions = [&] { return std::as_const(drives.car).first_collisions(); };
    while (std::ssize(collisions()) <= contact) {
      if (drives.ticks() * period > timeout)
        throw std::runtime_error(
            "the repeated lap has no such collision: another version drove the evaluation");
      if (drives.ticks() % lead == 0) before = std::exchange(latest, drives);
      drives.tick({});
    }
    hit = static_cast<int>(collisions()[static_cast<std::size_t>(contact)].time / period);
    while (before.ticks() < hit - lead) before.tick({});
  }
  install(std::move(loaded.scenario), loaded.names);
  waiting_ = state_.real_time = paused_ = false;
  rate_ = 1;
  if (hit >= 0) {
    drives_ = std::move(before);
    stop_at_ = hit + static_cast<int>(after_contact / control_period());
    rate_ = contact_rate;
  }
  state_.contact = {experiment, lap, contact, hit};
  pace_.due = Clock::now();
}

}  // namespace slalom::view
