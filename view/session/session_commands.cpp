#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "view/session/session.hpp"

#include "src/evaluation/json.hpp"
#include "view/session/command_fields.hpp"
#include "view/session/work_limit.hpp"

namespace slalom::view {
namespace {

constexpr int max_steps = 400;  // of one command "step"
constexpr double slowest_rate = 0.001;

std::uint64_t count(const std::string& digits) {
  if (digits.empty() || digits.size() > 19 || digits.find_first_not_of("0123456789") != std::string::npos)
    throw MalformedCommand("seed: must be a whole number from 0");
  return std::stoull(digits);
}

/// Applies the settings `set` of a command, a list of key=value. False if there are none.
bool apply_settings(vehicle::Configuration& configuration, const Json& command, const std::string& method) {
  const Json set = command.contains("set") ? command.at("set") : Json::array();
  if (!set.is_array() || set.size() > 200)
    throw MalformedCommand("set: must be a list of at most 200 key=value");
  for (const Json& each : set) {
    const std::string assignment = each.is_string() ? each.get<std::string>() : "";
    const auto equals = assignment.find('=');
    if (equals == std::string::npos) throw MalformedCommand("set: must be a list of key=value");
    vehicle::set_option(configuration, assignment.substr(0, equals), assignment.substr(equals + 1), method);
  }
  return !set.empty();
}

}  // namespace

void Session::obey(std::uint64_t client, const Json& command) {
  const std::string what = field::text(command, "do");
  state_changed_ = true;
  if (what == "step")
    handle_step(client, command);
  else if (what == "scenario")
    handle_scenario(command);
  else if (what == "lap")
    handle_lap(command);
  else if (what == "save")
    save(client, field::text(command, "what"));
  else if (what == "past")
    tell_past(client, field::integer(command, "from"), field::integer(command, "to"));
  else if (!handle_transport(what, command) && !handle_edit(what, command) && !handle_options(what, command))
    throw MalformedCommand("do: '" + what.substr(0, 40) + "' is not a command");
  end_introduction(what);
}

/// Asks for ticks, which `turn` then drives.
void Session::handle_step(std::uint64_t client, const Json& command) {
  const int ticks =
      command.contains("ticks") ? std::clamp(field::integer(command, "ticks"), 1, max_steps) : 1;
  go_to_viewed();
  waiting_ = false;
  paused_ = true;
  stepping_client_ = client;
  steps_left_ = std::min(steps_left_ + ticks, max_steps);
}

/// Pauses. A client that is more than 0.25 s behind keeps in view the tick that it says it shows.
void Session::pause(const Json& command) {
  paused_ = true;
  steps_left_ = 0;
  publish_newest();
  if (!command.contains("tick") || history_.empty()) return;
  const int tick = field::integer(command, "tick");
  if ((history_.back().tick - tick) * simulation_->loop().setup().control_period() > 0.25) show(tick);
}

bool Session::handle_transport(const std::string& what, const Json& command) {
  if (what == "pause") {
    pause(command);
  } else if (what == "play") {
    go_to_viewed();
    stop_at_ = -1;
    steps_left_ = 0;
    paused_ = waiting_ = false;
    due_ = Clock::now();
  } else if (what == "seek") {
    steps_left_ = 0;
    show(field::integer(command, "tick"));
  } else if (what == "rate") {
    const double rate = field::number(command, "rate");
    if (rate != 0 && !(rate >= slowest_rate && rate <= 100))
      throw MalformedCommand("rate: must be 0 for the maximum speed, or in [0.001, 100]");
    rate_ = rate;
    due_ = Clock::now();
  } else if (what == "real_time") {
    real_time_ = field::flag(command, "on");
    if (real_time_) rate_ = 1;
  } else if (what == "restart") {
    restart();
    paused_ = false;
  } else {
    return false;
  }
  return true;
}

bool Session::handle_edit(const std::string& what, const Json& command) {
  constexpr const char* edits[] = {"add", "move", "remove", "place_car", "nudge"};
  if (std::find(std::begin(edits), std::end(edits), what) == std::end(edits)) return false;
  go_to_viewed();
  const SetBodies before{bodies_of(simulation_->loop().world())};
  if (what == "add") {
    const std::string kind = field::text(command, "kind");
    AddBody body{.pose = field::pose(command)};
    if (kind == "car")
      body.kind = BodyKind::parked_car;
    else if (kind == "box")
      body.kind = BodyKind::box;
    else if (kind != "disc")
      throw MalformedCommand("kind: must be car, box or disc");
    body.length = field::number(command, "length", body.length);
    body.width = field::number(command, "width", body.length);
    if (!(body.length >= 0.02 && body.length <= 10 && body.width >= 0.02 && body.width <= 10))
      throw MalformedCommand("length and width: must be in [0.02, 10] m");
    edit(body);
    undo_.remember(before);
  } else if (what == "move") {
    edit(MoveBody{field::integer(command, "body"), field::pose(command)});
    undo_.remember_drag(before, command.contains("drag") ? field::integer(command, "drag") : 0);
  } else if (what == "remove") {
    edit(RemoveBody{field::integer(command, "body")});
    undo_.remember(before);
  } else if (what == "place_car") {
    edit(MoveCar{field::pose(command)});
  } else {
    const sim::CarState& car = simulation_->loop().world().state(0);
    const double aside = field::number(command, "left", 0), turn = field::number(command, "turn", 0);
    if (std::abs(aside) > 2 || std::abs(turn) > 3.2)
      throw MalformedCommand("nudge: must be at most 2 m and 3.2 rad");
    edit(MoveCar{{car.x - aside * std::sin(car.yaw), car.y + aside * std::cos(car.yaw), car.yaw + turn}});
  }
  tell_options();  // has the number of changes that can be undone
  return true;
}

void Session::edit(const Edit& edit) {
  simulation_->apply(edit);
  if (ghost_ && !std::holds_alternative<MoveCar>(edit)) ghost_->apply(edit);
  show_edit();
}

/// Another configuration or method drives from now on.
void Session::change(const vehicle::Configuration& configuration, const std::string& method, bool remember) {
  check_work(configuration, method);
  const evaluation::LapSetup setup = make_setup(configuration, method);
  // All that may throw comes before anything is replaced. With another clock the drive begins anew, without
  // a ghost, whose clock is the present one.
  std::optional<Simulation> anew;
  if (setup.control_period() != simulation_->loop().setup().control_period())
    anew.emplace(setup, names_.seed);
  else
    simulation_->apply(ChangeDriver{setup.driver});
  if (remember) undo_.remember(configuration_);
  configuration_ = configuration;
  names_.method = method;
  if (anew) begin_drive(std::move(*anew), {});
  tell_options();
}

/// Takes back the last change of options or of bodies, or with `again` the last undo.
void Session::undo(bool again) {
  go_to_viewed();
  const UndoHistory before = undo_;
  const SetBodies present{bodies_of(simulation_->loop().world())};
  const auto last = again ? undo_.take_redo(present) : undo_.take_undo(present);
  if (!last) throw std::invalid_argument(again ? "nothing to redo" : "nothing to undo");
  try {
    if (const auto* bodies = std::get_if<SetBodies>(&*last)) {
      edit(*bodies);
      undo_.replaced(present, again);
      return tell_options();
    }
    undo_.replaced(configuration_, again);
    change(std::get<vehicle::Configuration>(*last), names_.method, false);
  } catch (...) {
    undo_ = before;
    throw;
  }
}

void Session::end_ghost() {
  ghost_.reset();
  for (Redrive& each : redrives_) each.ghost.reset();
  ghost_method_.clear();
  ghost_label_.clear();
}

/// Starts a ghost in its own world with the same history, which has been driven again (see `redrive_for`).
void Session::start_ghost(const std::string& method, const vehicle::Configuration& configuration) {
  if (method.empty()) return end_ghost();
  set_ghost(make_ghost(method, configuration), method, method);
}

Simulation Session::make_ghost(const std::string& method, const vehicle::Configuration& configuration) {
  check_work(configuration, method);
  Simulation ghost =
      simulation_->ticks() == 0 ? simulation_->from_start() : std::move(prepared_.value().copy.value());
  if (method != names_.method || ghost.ticks() == 0) ghost.apply(ChangeDriver{{configuration, method}});
  return ghost;
}

void Session::set_ghost(Simulation ghost, const std::string& method, const std::string& label) {
  end_ghost();
  ghost_ = std::move(ghost);
  ghost_method_ = method;
  ghost_label_ = label;
}

/// Continues with another method or other options; the previous driver continues as a ghost.
void Session::fork(const Json& command) {
  const std::string method = field::text(command, "method"), before = names_.method;
  vehicle::Configuration changed = configuration_;
  const bool has_settings = apply_settings(changed, command, method);
  check_work(changed, method);
  const evaluation::LapSetup setup = make_setup(changed, method);
  setup.validate();  // throws before anything changes
  if (setup.control_period() != simulation_->loop().setup().control_period())
    throw std::invalid_argument("fork: the control period cannot change during a drive");
  go_to_viewed();
  Simulation ghost = make_ghost(before, configuration_);
  change(changed, method, has_settings);
  set_ghost(std::move(ghost), before, before == method ? before + " as before" : before);
}

bool Session::handle_options(const std::string& what, const Json& command) {
  if (what == "set") {
    vehicle::Configuration changed = configuration_;
    vehicle::set_option(changed, field::text(command, "key"), field::text(command, "value"), names_.method);
    go_to_viewed();
    change(changed, names_.method, true);
  } else if (what == "undo" || what == "redo") {
    undo(what == "redo");
  } else if (what == "reset_options") {
    go_to_viewed();
    change(scenario_.configuration, names_.method, true);
  } else if (what == "preset") {
    vehicle::Configuration changed = scenario_.configuration;
    apply_settings(changed, command, names_.method);
    go_to_viewed();
    change(changed, names_.method, true);
  } else if (what == "method") {
    go_to_viewed();
    change(configuration_, field::text(command, "method"), false);
  } else if (what == "fork") {
    fork(command);
  } else if (what == "ghost") {
    go_to_viewed();
    start_ghost(field::text(command, "method"), configuration_);
  } else {
    return false;
  }
  return true;
}

void Session::handle_scenario(const Json& command) {
  ScenarioNames names = names_;
  if (command.contains("course")) names.course = field::text(command, "course");
  if (command.contains("method")) names.method = field::text(command, "method");
  if (command.contains("config")) names.config = field::text(command, "config");
  if (command.contains("seed")) names.seed = count(field::text(command, "seed"));
  if (command.contains("obstacles")) names.obstacles = field::integer(command, "obstacles");
  if (command.contains("opponents")) names.opponents = field::integer(command, "opponents");
  if (names.opponents < 0 || names.opponents > 16) throw MalformedCommand("opponents: must be in [0, 16]");
  if (names.obstacles < 0 || names.obstacles > 60) throw MalformedCommand("obstacles: must be in [0, 60]");
  // A page may only choose from the listed courses; it must not make the server read other folders.
  const auto known = [](const std::vector<std::string>& all, const std::string& name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  if (names.course != options_.scenario.course && !known(options_.choices.courses, names.course))
    throw std::invalid_argument("course: '" + names.course + "' is unknown");
  if (names.config != options_.scenario.config && !known(options_.choices.configurations, names.config))
    throw std::invalid_argument("config: '" + names.config + "' is unknown");
  load(names);
  paused_ = false;
}

}  // namespace slalom::view
