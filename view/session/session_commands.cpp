
#include "json/json.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

maps::Pose pose_of(const Json& command) {
  return {field::number(command, "x"), field::number(command, "y"), field::number(command, "yaw", 0)};
}

Shape added_shape(const Json& command, const SubjectFacts& facts) {
  Shape shape{.pose = pose_of(command), .length = 0.3};
  const std::string kind = field::text(command, "kind");
  field::require(kind == "car" || kind == "box" || kind == "disc", "kind", "car, box or disc");
  shape.is_disc = kind == "disc";
  shape.length = field::number(command, "length", shape.length);
  shape.width = field::number(command, "width", shape.length);
  const double least = std::min(shape.length, shape.width), most = std::max(shape.length, shape.width);
  field::require(least >= 0.02 && most <= 10, "length and width", "in [0.02, 10] m");
  if (kind != "car") return shape;
  return {.pose = shape.pose, .length = facts.length, .width = facts.width, .kind = ShapeKind::parked_car};
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

/// Returns the pose of the commands place_car and nudge.
maps::Pose placed_pose(const std::string& what, const Json& command, const maps::Pose& now) {
  if (what == "place_car") return pose_of(command);
  const double aside = field::number(command, "left", 0), turn = field::number(command, "turn", 0);
  field::require(std::abs(aside) <= 2 && std::abs(turn) <= 3.2, "nudge", "at most 2 m and 3.2 rad");
  return {now.x - aside * std::sin(now.yaw), now.y + aside * std::cos(now.yaw), now.yaw + turn};
}

/// Returns the settings `set` of a command, a list of key=value.
OptionTexts settings_in(const Json& command) {
  const Json set = command.contains("set") ? command.at("set") : Json::array();
  field::require(set.is_array() && set.size() <= 200, "set", "a list of at most 200 key=value");
  OptionTexts texts;
  for (const Json& each : set) {
    const std::string assignment = each.is_string() ? each.get<std::string>() : "";
    const auto equals = assignment.find('=');
    field::require(equals != std::string::npos, "set", "a list of key=value");
    texts[assignment.substr(0, equals)] = assignment.substr(equals + 1);
  }
  return texts;
}

/// The scenario that the command scenario chooses; only listed courses and configurations are allowed.
ScenarioNames chosen_scenario(ScenarioNames names, const Json& command, const Choices& choices) {
  const auto choose = [&](const char* key, std::string& name, const std::vector<std::string>& all) {
    if (!command.contains(key)) return;
    const std::string wanted = field::text(command, key);
    // A page must not make the server read other folders than those that are listed or already open.
    if (wanted != name && std::find(all.begin(), all.end(), wanted) == all.end())
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

}  // namespace

void Session::obey(std::uint64_t client, const std::string& what, const Json& command) {
  if (what == "past") {
    const int from = field::integer(command, "from"), to = field::integer(command, "to");
    return server_.send(client, {shared(timeline_.past(from, to)), true});
  }
  if (what == "take_over") return audience_.take_over(client);
  if (what == "save" && options_.save) return save(client, field::text(command, "what"));
  audience_.require_driver(client);
  is_state_changed_ = true;
  if (!obey_transport(what, command) && !obey_edit(what, command) && !obey_options(what, command))
    throw MalformedCommand("do: '" + what.substr(0, 40) + "' is not a command of this page");
}

bool Session::obey_edit(const std::string& what, const Json& command) {
  const SubjectFacts& facts = this->facts();
  if ((what == "place_car" && facts.can_place) || (what == "nudge" && facts.can_add)) {
    Run& now = present().driven;
    perform(place_body(placed_pose(what, command, now.subject->poses(now.state).front())));
    return true;
  }
  Action action;
  if (what == "move" && facts.can_move)
    action = move_shape(field::integer(command, "body") - 1, pose_of(command));
  else if (what == "add" && facts.can_add)
    action = add_shape(added_shape(command, facts));
  else if (what == "remove" && facts.can_add)
    action = remove_shape(field::integer(command, "body") - 1);
  else
    return false;
  const int drag = field::integer(command, "drag", 0);
  Shapes before = shapes();
  perform(action, facts.scans_ahead);
  remember(std::move(before), drag);
  return true;
}

bool Session::obey_options(const std::string& what, const Json& command) {
  if (what == "real_time" && facts().can_delay) {
    state_.real_time = field::flag(command, "on");
    if (state_.real_time) state_.rate = 1;
  } else if (what == "scenario" && options_.load) {
    ScenarioNames names = state_.names;
    names.method = settings().method;
    names = chosen_scenario(std::move(names), command, options_.choices);
    std::unique_ptr<Subject> subject = options_.load(names);
    state_.names = std::move(names);
    state_.paused = false;
    install(std::move(subject));
  } else if (what == "set") {
    change_options(set_options({{field::text(command, "key"), field::text(command, "value")}}));
  } else if (what == "reset_options") {
    change_options(set_options(changed_texts(settings(), loaded_)));
  } else if (what == "method") {
    change_options(change_method(options_for(field::text(command, "method"))));
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

void Session::change_options(const Action& action) {
  Settings before = settings();
  perform(action);
  remember(std::move(before));
}

/// Returns the options with which a method begins, and notes those that it would have without changes.
SolverOptions Session::options_for(const std::string& method) {
  const Subject& subject = *present().driven.subject;
  const Settings& now = settings();
  const SolverOptions loaded = method_options(subject, method, loaded_, now.method);
  add_texts(loaded_, {{method, list_options(loaded)}});
  return method_options(subject, method, now.texts(), now.method);
}

/// Takes the last change back, or with `again` the last undo.
void Session::undo(bool again) {
  auto &from = again ? redo_ : undo_, &to = again ? undo_ : redo_;
  if (from.empty()) throw std::invalid_argument(again ? "nothing to redo" : "nothing to undo");
  continue_from_shown();
  if (from.empty()) return;  // going back has undone it
  const Change last = from.back();
  Change replaced{last.ticks, settings()};
  if (const auto* before = std::get_if<Shapes>(&last.before)) {
    replaced.before = shapes();
    perform(set_shapes(*before), facts().scans_ahead);
  } else {
    perform(restore(std::get<Settings>(last.before)));
  }
  from.pop_back();
  replaced.ticks = acted_;
  to.push_back(std::move(replaced));
  drag_ = 0;
}

/// Continues with another method or other options; what drove until now continues as a ghost.
void Session::fork(const Json& command) {
  const std::string method = field::text(command, "method"), before = settings().method;
  std::optional<SolverOptions> other;
  if (method != before) other = options_for(method);
  const Action ghost = start_ghost(before == method ? before + " as before" : before);
  change_options([=, texts = settings_in(command)](Drives& drives) {
    ghost(drives);
    if (other) change_method (*other)(drives);
    set_options(texts)(drives);
    const double step = drives.driven.subject->time_step();
    if (step > 0 && step != drives.driven.period)
      throw std::invalid_argument("fork: the control period cannot change during a drive");
  });
}

/// Starts a ghost with a method as a copy of what is driven; without one, ends the ghost.
void Session::set_ghost(const std::string& method) {
  if (method.empty()) return perform(end_ghost);
  std::optional<SolverOptions> other;
  if (method != settings().method) other = options_for(method);
  perform(start_ghost(method, std::move(other)));
}

}  // namespace slalom::view
