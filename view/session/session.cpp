#include "view/session/session.hpp"

#include <algorithm>
#include <utility>

#include "view/protocol/frame_reader.hpp"

namespace slalom::view {
namespace {

constexpr auto min_frame_gap = std::chrono::milliseconds(12);  // no screen shows more
constexpr auto max_state_gap = std::chrono::seconds(1);
constexpr int max_late_ticks = 4;  // ticks that a late clock may owe

std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

/// About the bytes that a copy of a controller needs: the batch of samples, and other arrays of that order.
std::size_t bytes_of(const SolveResult* solve) {
  if (!solve || !solve->samples) return 0;
  const SequenceBatch& batch = *solve->samples;
  return std::size_t{8} * sizeof(float) * static_cast<std::size_t>(batch.samples()) *
         static_cast<std::size_t>(batch.steps()) * static_cast<std::size_t>(batch.inputs());
}

/// The message of a tick: the blocks of the car, the bodies of its world, and the same of the ghost.
std::string frame_of(std::string_view car, std::string_view ghost, const Drives& drives) {
  std::string frame = std::string(car) + encode_bodies(drives.car.world());
  if (drives.ghost && !ghost.empty())
    frame += encode_ghost_frame(std::string(ghost) + encode_bodies(drives.ghost->world()));
  return frame;
}

/// The part of a message before its bodies.
std::string_view before_bodies(std::string_view frame) {
  constexpr std::size_t head = 8;  // length of the head of a block
  return frame.empty() ? frame : frame.substr(0, FrameReader(frame).offset(Block::bodies) - head);
}

}  // namespace

Session::Session(SessionOptions options, Server& server)
    : options_(std::move(options)), server_(server), waiting_(options_.wait_for_client) {
  install(options_.load(options_.scenario), options_.scenario);
  if (!options_.against.empty()) start_ghost(options_.against);
  introduces_ = options_.introduction;
  slow_down();
}

void Session::run(const std::atomic<bool>& stop) {
  while (!stop) {
    const auto wait = std::min<Clock::duration>(until_due(), std::chrono::milliseconds(50));
    if (wait > Clock::duration::zero()) server_.wait(wait);
    turn();
  }
}

void Session::turn() {
  for (const Received& each : server_.take()) handle(each);
  if (until_due() <= Clock::duration::zero()) {
    if (steps_left_ > 0) --steps_left_;
    tick();
  }
  const auto now = Clock::now();
  if (server_.clients() == 0 || !(is_state_changed_ || now - last_state_ > max_state_gap)) return;
  last_state_ = now;
  is_state_changed_ = false;
  tell_text(0, state());
}

Session::Clock::duration Session::until_due() const {
  if (steps_left_ > 0) return Clock::duration::zero();
  if (waiting_ || paused_) return std::chrono::hours(1);
  if (rate_ <= 0) return Clock::duration::zero();
  return due_ - Clock::now();
}

Drives Session::start_of(const LoadedScenario& scenario, const ScenarioNames& names) const {
  return {evaluation::LapDrive({scenario.environment, {scenario.configuration, names.method}, scenario.lap},
                               names.seed)};
}

/// Drives a scenario from its start, without a ghost.
void Session::install(LoadedScenario loaded, const ScenarioNames& names) {
  // Everything that may throw comes before anything is replaced.
  Drives drives = start_of(loaded, names);
  scene_ = shared(encode_scene(*loaded.environment));
  scenario_ = std::move(loaded);
  names_ = names;
  undo_ = {};
  server_.send(0, {scene_, true});
  begin(std::move(drives));
}

/// Drives again from the start with the same seed and the present drivers of car and ghost.
void Session::restart() {
  LoadedScenario scenario = scenario_;
  scenario.configuration = driver().configuration;
  ScenarioNames names = names_;
  names.method = driver().method;
  Drives drives = start_of(scenario, names);
  if (drives_->ghost) drives.apply(StartGhost{drives_->ghost->setup().driver, drives_->ghost_label});
  begin(std::move(drives));
}

void Session::begin(Drives drives) {
  drives_ = std::move(drives);
  timeline_.begin(options_.history, control_period());
  laps_.clear();
  undo_.forget_bodies();
  viewed_ = stop_at_ = -1;
  steps_left_ = 0;
  contact_.fill(-1);
  slow_motion_ = {};
  slow_down();
  ++generation_;
  due_ = Clock::now();
  is_state_changed_ = true;
  tell_options();
}

void Session::tick() {
  if (rate_ > 0) {
    const auto period = std::chrono::duration<double>(control_period());
    const auto step = std::chrono::duration_cast<Clock::duration>(period / rate_);
    due_ = std::max(due_ + step, Clock::now() - max_late_ticks * step);
  }
  Drives& drives = *drives_;
  timeline_.checkpoint(drives, copy_bytes_);
  copy_bytes_ = 0;
  std::string car, ghost_car, ghost;
  const Delays delays = real_time_ ? last_updates_ : Delays{};
  const auto on_ghost = [&](const evaluation::ControlStep& step) {
    std::vector<maps::Pose> plan;
    for (const auto& state : step.output.predicted) plan.push_back(state.pose);
    ghost_car = encode_ghost(step.world, plan);
    ghost = encoder_.encode(step, facts_of(*drives.ghost));
    last_updates_.ghost = step.output.tick_time;
    copy_bytes_ += bytes_of(step.output.solve);
  };
  const int number = drives.ticks();
  std::string frame;
  const auto on_car = [&](const evaluation::ControlStep& step) {
    car = encoder_.encode(step, facts_of(drives.car)) + ghost_car;
    last_updates_.car = step.output.tick_time;
    copy_bytes_ += bytes_of(step.output.solve);
    frame = frame_of(car, ghost, drives);
  };
  drives.tick(delays, on_car, on_ghost);
  timeline_.keep({number, delays, shared(std::move(frame))});
  note_laps(drives.car, driver().method, false);
  if (drives.ghost) note_laps(*drives.ghost, drives.ghost_label, true);
  slow_down();
  if (number == stop_at_) {
    paused_ = is_state_changed_ = true;
    stop_at_ = -1;
  }
  is_newest_sent_ = false;
  if (Clock::now() - last_frame_ >= min_frame_gap || paused_) publish_newest();
}

StepFacts Session::facts_of(const evaluation::LapDrive& drive) const {
  const auto& methods = options_.choices.methods;
  const evaluation::Driver& driver = drive.setup().driver;
  return {.deadline = drive.setup().control_period(),
          .prediction_step = driver.configuration.vehicle.time_step,
          .method = static_cast<int>(std::ranges::find(methods, driver.method) - methods.begin())};
}

void Session::publish_newest() {
  if (std::exchange(is_newest_sent_, true) || timeline_.empty()) return;
  last_frame_ = Clock::now();
  server_.publish(0, timeline_.steps().back().frame);
}

void Session::note_laps(const evaluation::LapDrive& drive, const std::string& method, bool is_ghost) {
  const sim::LapTimer& timer = *drive.world().laps(0);
  int laps = 0, contacts = 0;
  for (const LapNote& lap : laps_) {
    if (lap.ghost != is_ghost) continue;
    laps = lap.lap;
    contacts += lap.contacts;
  }
  if (timer.laps() <= laps) return;
  laps_.push_back({.tick = drive.steps(),
                   .lap = timer.laps(),
                   .time = timer.last_lap_time(),
                   .contacts = drive.collisions() - contacts,
                   .method = method,
                   .ghost = is_ghost});
  is_state_changed_ = true;
}

/// Pauses and shows a stored tick.
void Session::show_step(int tick) {
  if (timeline_.empty()) return;
  tick = std::clamp(tick, timeline_.oldest(), timeline_.newest());
  viewed_ = tick == timeline_.newest() ? -1 : tick;
  paused_ = is_newest_sent_ = is_state_changed_ = true;
  server_.publish(0, timeline_.at(tick).frame);
}

/// Keeps the introduction in slow motion until the obstacle has been passed.
void Session::slow_down() {
  if (!introduces_ || slow_motion_.is_over()) return;
  const auto* ghost = drives_->ghost ? &std::as_const(*drives_->ghost).world() : nullptr;
  const double rate = slow_motion_.rate({&std::as_const(drives_->car).world(), ghost});
  is_state_changed_ = is_state_changed_ || rate != rate_;
  rate_ = rate;
}

/// A copy of the drives as they were after the tick that is shown.
Drives Session::shown() const {
  return viewed_ >= 0 ? timeline_.after(viewed_) : *drives_;
}

/// Makes a copy that `shown` returned the present, after these actions have been applied to it.
void Session::commit(Drives drives, const std::vector<Action>& actions) {
  const bool is_back = viewed_ >= 0;
  drives_ = std::move(drives);
  if (is_back) {
    timeline_.forget_after(viewed_);
    std::erase_if(laps_, [&](const LapNote& lap) { return lap.tick > viewed_ + 1; });
    viewed_ = -1;
    due_ = Clock::now();
  }
  for (const Action& each : actions) timeline_.note(drives_->ticks(), each);
  is_state_changed_ = true;
  if (is_back || !actions.empty()) tell_options();
}

/// Applies actions to the drives, from the tick that is shown on. If one throws, nothing has changed.
void Session::perform(const std::vector<Action>& actions) {
  Drives drives = shown();
  for (const Action& each : actions) drives.apply(each);
  commit(std::move(drives), actions);
}

/// Edits the worlds. While nothing moves, this is shown at once.
void Session::edit(const Action& action, int drag) {
  Drives drives = shown();
  const SetBodies before{bodies_of(std::as_const(drives.car).world())};
  drives.apply(action);
  if (!std::holds_alternative<MoveCar>(action)) undo_.remember(before, drag);
  commit(std::move(drives), {action});
  if (timeline_.empty()) return;
  const std::string& frame = *timeline_.steps().back().frame;
  const std::string_view ghost = FrameReader(frame).block(Block::ghost_frame);
  timeline_.show(shared(frame_of(before_bodies(frame), before_bodies(ghost), *drives_)));
  if (paused_) server_.publish(0, timeline_.steps().back().frame);
}

}  // namespace slalom::view
