#include "view/session/session.hpp"

#include "json/json.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom::view {
namespace {

constexpr std::size_t max_changes = 200;  // that can be undone
// One is not always enough for a plan on the other side of an obstacle that was moved into the way.
constexpr int solves_of_change = 3;

}  // namespace

Session::Session(std::unique_ptr<Subject> subject, Server& server, SessionOptions options)
    : server_(server), audience_(server), options_(std::move(options)) {
  state_.names = options_.scenario;
  if (options_.choices.methods.empty())
    for (const char* name : solver_names()) options_.choices.methods.emplace_back(name);
  install(std::move(subject));
  if (!options_.against.empty()) set_ghost(options_.against);
}

/// Drives a subject from its start, without a ghost.
void Session::install(std::unique_ptr<Subject> subject) {
  Drives drives{Run(std::move(subject))};
  std::string scene = encode_scene(drives.driven.subject->facts());
  scene_ = scene.empty() ? nullptr : shared(std::move(scene));
  loaded_ = drives.driven.settings->texts();
  undo_.clear();
  redo_.clear();
  if (scene_) server_.send(0, {scene_, true});
  begin(std::move(drives));
}

/// Begins with other drives, without a past.
void Session::begin(Drives drives) {
  drives_ = std::move(drives);
  timeline_ = Timeline(control_period(), options_.packing);
  held_.reset();
  if (!facts().course.empty()) state_.bounds = bounds_of(facts().course);
  laps_ = 0;
  viewed_ = -1;
  steps_left_ = 0;
  ++state_.generation;
  pace_ = {};
  is_state_changed_ = true;
  // Options can still be set back; the shapes of another scene cannot.
  for (auto* changes : {&undo_, &redo_}) {
    std::erase_if(*changes, [](const Change& each) { return each.before.index() == 1; });
    for (Change& each : *changes) each.ticks = 0;
  }
  if (state_.paused) tick();
}

void Session::tick() {
  pace_.step(control_period(), state_.rate);
  timeline_.checkpoint(*drives_);
  keep(drive(*drives_, 1));
  offer_newest();
}

/// Drives one step. `solves`: DriveRequest::solves.
DrivenTick Session::drive(Drives& drives, int solves) {
  DrivenTick driven{.tick = drives.ticks(), .settings = drives.driven.settings};
  for (std::size_t i = 0; i < 2; ++i)
    driven.records[i] = {.delay = state_.real_time ? last_updates_[i] : 0, .solves = solves};
  std::string ghost;
  if (drives.ghost)
    ghost = encode_ghost_frame(drive(*drives.ghost, driven.records[1], last_updates_[1]).message);
  Frame frame = drive(drives.driven, driven.records[0], last_updates_[0]);
  driven.bounds = frame.bounds;
  driven.frame = shared(std::move(frame.message) + ghost);
  driven.keep_scalars(scalar_names(facts()).size());
  return driven;
}

/// Drives one of two one step further and returns the frame of the step. `update_time` becomes the s of wall
/// clock that the plan took.
Frame Session::drive(Run& run, StepRecord& record, double& update_time) {
  Frame frame;
  const SolverOptions* options = run.subject->options();
  const int method = options_.choices.method_index(options ? options->method() : "");
  run.tick(record, [&](const SolveResult& solve, double seconds) {
    const StepMeasures own{.time = run.steps * run.period,
                           .update_time = seconds,
                           .collisions = run.collisions,
                           .prediction_step = run.period};
    frame = encode_frame(*run.subject, solve,
                         {.tick = run.steps,
                          .measures = run.subject->measures().value_or(own),
                          .period = run.period,
                          .method = method,
                          .state = run.state});
    record.collides = frame.collides;
    update_time = seconds;
  });
  return frame;
}

/// Keeps a step that was driven.
void Session::keep(DrivenTick tick) {
  const Bounds& b = tick.bounds;
  if (tick.tick == 0) state_.bounds = b;
  state_.bounds.include(b.x0, b.y0);
  state_.bounds.include(b.x1, b.y1);
  timeline_.keep(std::move(tick));
  const std::size_t laps = drives_->laps().size();
  is_state_changed_ = is_state_changed_ || laps != std::exchange(laps_, laps);
}

StoredDrive Session::record(int steps) {
  while (timeline_.newest() + 1 < steps) tick();
  return stored();
}

/// Applies an action to the drives, from the tick that is shown on. While nothing moves, this tick is driven
/// again, so that the plan that is shown belongs to the change. The scan of a tick may have been taken at the
/// end of the tick before; a change of what it sees then has the `lead` 1: both are driven again. With
/// another duration of steps the drive begins anew. If the action, a solve or a function of the drawing
/// throws, nothing has changed.
void Session::perform(const Action& action, int lead) {
  const bool is_driven_again = is_held();
  const int shown = shown_tick();
  Drives drives = present(lead);
  action(drives);
  is_state_changed_ = true;
  const double step = drives.driven.subject->time_step();
  if (step > 0 && step != drives.driven.period) {
    acted_ = 0;
    return begin(drives.restarted());
  }
  const int acted = drives.ticks();
  std::optional<Drives> before;
  std::vector<DrivenTick> ticks;
  if (is_driven_again) {
    before = drives;
    while (drives.ticks() <= shown) {
      if (!ticks.empty()) timeline_.act(drives);
      ticks.push_back(drive(drives, solves_of_change));
    }
    forget_after(acted - 1, shown);
  }
  acted_ = acted;
  timeline_.note(acted, action);
  drives_ = std::move(drives);
  if (!is_driven_again) return;
  timeline_.checkpoint(*before);
  held_ = std::move(before);
  for (DrivenTick& each : ticks) keep(std::move(each));
  is_newest_sent_ = false;
  publish_newest();
}

/// Returns the shapes that a change applies to.
Session::Shapes Session::shapes() {
  return present(facts().scans_ahead).driven.subject->shapes();
}

/// Stores what a change has replaced, so that it can be undone; what was undone cannot be done again after
/// it. Changes of the same drag count as one; 0 is never the same.
void Session::remember(decltype(Change::before) before, int drag) {
  if (drag != 0 && drag == std::exchange(drag_, drag)) return;
  drag_ = drag;
  undo_.push_back({acted_, std::move(before)});
  if (undo_.size() > max_changes) undo_.erase(undo_.begin());
  redo_.clear();
}

void Session::join(std::uint64_t client) {
  if (std::exchange(waiting_, false)) {
    pace_.due = Clock::now();
    tick();
  }
  audience_.tell_text(client, hello());
  if (scene_) server_.send(client, {scene_, true});
  audience_.tell_text(client, options_message(options_facts()));
  audience_.tell_text(client, state());
  if (!timeline_.empty()) server_.publish(client, timeline_.frame(shown_tick()));
}

void Session::tell() {
  std::string now = options_message(options_facts());
  if (now != std::exchange(told_options_, now)) audience_.tell_text(0, std::move(now));
  audience_.tell_text(0, state());
}

std::string Session::hello() const {
  std::vector<std::string> can;
  for (const auto& [word, holds] : {std::pair("place", facts().can_place),
                                    {"move", facts().can_move},
                                    {"add", facts().can_add},
                                    {"scenario", bool(options_.load)},
                                    {"real_time", facts().can_delay},
                                    {"save", bool(options_.save)},
                                    {"ghost", !settings().method.empty()},
                                    {"introduction", options_.introduction}})
    if (holds) can.emplace_back(word);
  return hello_message(facts(), options_.choices, stored_seconds, control_period(), can);
}

std::string Session::state() const {
  DriveState now = state_;
  now.laps = drives_->laps();
  now.names.method = settings().method;
  now.time = drives_->ticks() * control_period();
  now.tick = shown_tick();
  now.newest = timeline_.newest();
  now.oldest = timeline_.oldest();
  now.edited = drives_->edited;
  if (drives_->ghost) now.ghost = drives_->ghost->settings->method;
  now.ghost_label = drives_->ghost_label;
  now.control_period = control_period();
  return state_message(now);
}

OptionsFacts Session::options_facts() const {
  ScenarioNames names = state_.names;
  names.method = settings().method;
  return {.names = names,
          .sections = settings().sections,
          .fixes_seed = facts().fixes_seed,
          .loaded = loaded_,
          .further_arguments = options_.further_arguments,
          .undo = undo_.size(),
          .redo = redo_.size()};
}

/// Sends the last minute to a client as a file.
void Session::save(std::uint64_t client, const std::string& what) {
  if (what != "replay" && what != "recording")
    throw std::invalid_argument("what: must be recording or replay");
  if (timeline_.empty()) throw std::invalid_argument("nothing has been driven yet");
  options_.save(what, stored(),
                [&server = server_, client](Message message) { server.send(client, std::move(message)); });
}

/// Returns the last minute.
StoredDrive Session::stored() const {
  const OptionsFacts options = options_facts();
  return {.hello = hello(),
          .options = options_message(options),
          .state = state(),
          .scene = scene_,
          .ticks = timeline_.stored(),
          .name = "slalom-" + facts().title + "-" + options.names.method + "-" +
                  std::to_string(timeline_.newest()),
          .command_line = command_line(options),
          .scanner = facts().scanner};
}

}  // namespace slalom::view
