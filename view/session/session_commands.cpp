#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "src/evaluation/json.hpp"
#include "view/session/commands.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

constexpr int max_steps = 400;  // ticks of one command "step"
constexpr double least_rate = 0.001, most_rate = 100;
constexpr double max_lag = 0.25;                              // s that a page may be behind when it pauses
constexpr double before_contact = 2.0, after_contact = 0.25;  // s that are shown of a collision
constexpr double contact_rate = 0.25;

bool is_among(std::initializer_list<std::string_view> names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

void Session::handle(const Received& received) {
  if (received.kind == Received::Kind::joined) return join(received.client);
  if (received.kind == Received::Kind::left) return leave(received.client);
  execute(received.client, parse_json_or_null(received.text));
}

/// Executes a command and answers it: an error with the reason, and `done` if the command has an `id`.
void Session::execute(std::uint64_t client, const Json& command) {
  const auto id = command.find("id");
  const bool has_id = id != command.end() && id->is_number_integer();
  const auto fail = [&](const char* why) {
    Json error = {{"type", "error"}, {"message", why}};
    if (has_id) error["id"] = *id;
    tell(client, error);
  };
  try {
    if (!command.is_object()) throw MalformedCommand("a command must be a JSON object");
    obey(client, field::text(command, "do"), command);
    if (has_id) tell(client, {{"type", "done"}, {"id", *id}});
  } catch (const MalformedCommand& error) {
    ++refused_;
    fail(error.what());
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void Session::obey(std::uint64_t client, const std::string& what, const Json& command) {
  if (what == "past")
    return tell_past(client, field::integer(command, "from"), field::integer(command, "to"));
  if (what == "save") return save(client, field::text(command, "what"));
  if (what == "take_over") {
    driving_client_ = client;
    return tell_roles();
  }
  if (client != driving_client_)
    throw std::invalid_argument("another page drives this car; take over to change it");
  is_state_changed_ = true;
  if (what == "nudge" && viewed_ >= 0) perform({});  // it is relative to where the car is shown
  if (const auto action = edit_of(what, command, std::as_const(drives_->car).world().state(0)))
    edit(*action, field::integer(command, "drag", 0));
  else if (!obey_transport(what, command) && !obey_options(what, command))
    throw MalformedCommand("do: '" + what.substr(0, 40) + "' is not a command");
  // Another scenario or another rate ends the introduction.
  const bool is_other = is_among({"scenario", "method", "fork", "ghost", "set", "reset_options"}, what);
  if (!introduces_ || !(is_other || is_among({"rate", "real_time", "lap"}, what))) return;
  introduces_ = false;
  if (is_other) rate_ = 1;
}

bool Session::obey_transport(const std::string& what, const Json& command) {
  if (what == "pause") {
    paused_ = true;
    steps_left_ = 0;
    publish_newest();
    // A page that is far behind keeps the tick that it shows.
    const int tick = field::integer(command, "tick", timeline_.newest());
    if ((timeline_.newest() - tick) * control_period() > max_lag) show_step(tick);
  } else if (what == "play") {
    if (viewed_ >= 0) perform({});
    stop_at_ = -1;
    steps_left_ = 0;
    paused_ = waiting_ = false;
    due_ = Clock::now();
  } else if (what == "step") {
    const int ticks = std::clamp(field::integer(command, "ticks", 1), 1, max_steps);
    if (viewed_ >= 0) perform({});
    waiting_ = false;
    paused_ = true;
    steps_left_ = std::min(steps_left_ + ticks, max_steps);
  } else if (what == "seek") {
    steps_left_ = 0;
    show_step(field::integer(command, "tick"));
  } else if (what == "rate") {
    const double rate = field::number(command, "rate");
    if (rate != 0 && !(rate >= least_rate && rate <= most_rate))
      throw MalformedCommand("rate: must be 0 for the maximum speed, or in [0.001, 100]");
    rate_ = rate;
    due_ = Clock::now();
  } else if (what == "real_time") {
    real_time_ = field::flag(command, "on");
    if (real_time_) rate_ = 1;
  } else if (what == "restart") {
    restart();
    paused_ = false;
  } else if (what == "scenario") {
    ScenarioNames present = names_;
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
  const evaluation::Driver present = driver();
  if (what == "set") {
    vehicle::Configuration changed = present.configuration;
    vehicle::set_option(changed, field::text(command, "key"), field::text(command, "value"), present.method);
    change_driver(changed, present.method, true);
  } else if (what == "reset_options") {
    change_driver(scenario_.configuration, present.method, true);
  } else if (what == "method") {
    change_driver(present.configuration, field::text(command, "method"), false);
  } else if (what == "undo" || what == "redo") {
    undo(what == "redo");
  } else if (what == "fork") {
    fork(command);
  } else if (what == "ghost") {
    start_ghost(field::text(command, "method"));
  } else {
    return false;
  }
  return true;
}

/// Lets another configuration or method drive. With another control period the drive begins anew.
void Session::change_driver(const vehicle::Configuration& configuration, const std::string& method,
                            bool remember) {
  const vehicle::Configuration before = driver().configuration;
  const evaluation::LapSetup setup{scenario_.environment, {configuration, method}, scenario_.lap};
  if (setup.control_period() == control_period())
    perform({ChangeDriver{setup.driver}});
  else
    begin({evaluation::LapDrive(setup, names_.seed)});
  if (remember) undo_.remember(before);
  tell_options();
}

void Session::undo(bool again) {
  UndoHistory history = undo_;
  const SetBodies present{bodies_of(std::as_const(drives_->car).world())};
  const auto last = history.take(again, driver().configuration, present);
  if (!last) throw std::invalid_argument(again ? "nothing to redo" : "nothing to undo");
  if (const auto* bodies = std::get_if<SetBodies>(&*last))
    edit(*bodies, 0);
  else
    change_driver(std::get<vehicle::Configuration>(*last), driver().method, false);
  undo_ = std::move(history);
  tell_options();
}

/// Continues with another method or other options; the present driver continues as a ghost.
void Session::fork(const Json& command) {
  const std::string method = field::text(command, "method"), before = driver().method;
  vehicle::Configuration changed = driver().configuration;
  const bool has_settings = apply_settings(changed, command, method);
  const evaluation::LapSetup setup{scenario_.environment, {changed, method}, scenario_.lap};
  if (setup.control_period() != control_period())
    throw std::invalid_argument("fork: the control period cannot change during a drive");
  const vehicle::Configuration replaced = driver().configuration;
  perform(
      {StartGhost{.label = before == method ? before + " as before" : before}, ChangeDriver{setup.driver}});
  if (has_settings) undo_.remember(replaced);
  tell_options();
}

void Session::start_ghost(const std::string& method) {
  if (method.empty()) return perform({EndGhost{}});
  std::optional<evaluation::Driver> other;
  if (method != driver().method) other = {driver().configuration, method};
  perform({StartGhost{other, method}});
}

/// Shows a lap of the evaluation: from its start, or the seconds before one of its collisions.
void Session::show_lap(const Json& command) {
  if (!options_.load_lap) throw std::invalid_argument("lap: no evaluation is open");
  const int experiment = field::integer(command, "experiment"), lap = field::integer(command, "lap"),
            contact = field::integer(command, "contact", -1);
  tell(0, {{"type", "note"}, {"message", "Driving lap " + std::to_string(lap) + " again \xE2\x80\xA6"}});
  LoadedLap loaded = options_.load_lap(experiment, lap);
  int hit = -1;
  std::optional<Drives> before;
  if (contact >= 0) {
    Drives drives = start_of(loaded.scenario, loaded.names);
    const double period = drives.car.setup().control_period(), timeout = drives.car.setup().timeout();
    const int lead = static_cast<int>(before_contact / period);
    const auto collisions = [&] { return drives.car.first_collisions(); };
    Timeline search;
    search.begin(timeout, period);
    while (std::ssize(collisions()) <= contact) {
      if (drives.ticks() * period > timeout)
        throw std::runtime_error(
            "the repeated lap has no such collision: another version drove the evaluation");
      search.checkpoint(drives, copy_bytes_);
      drives.tick({});
      search.keep({drives.ticks() - 1, {}, std::make_shared<const std::string>()});
    }
    hit = static_cast<int>(collisions()[static_cast<std::size_t>(contact)].time / period);
    if (hit > lead) before = search.after(hit - lead - 1);
  }
  install(std::move(loaded.scenario), loaded.names);
  waiting_ = real_time_ = paused_ = false;
  rate_ = 1;
  if (hit >= 0) {
    if (before) drives_ = std::move(before);
    stop_at_ = hit + static_cast<int>(after_contact / control_period());
    rate_ = contact_rate;
  }
  contact_ = {experiment, lap, contact, hit};
  due_ = Clock::now();
}

}  // namespace slalom::view
