#include "view/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "view/protocol/frame_reader.hpp"

namespace slalom::view {
namespace {

constexpr std::size_t max_changes = 200;  // that can be undone

// The introduction, in slow motion until the cars have passed the obstacle.
constexpr double approaching_rate = 0.5, passing_rate = 0.1;
constexpr double reach = 4;             // m from the car to an obstacle ahead, about the length of a plan
constexpr double beside = 1.5;          // m to either side of the car's axis
constexpr double behind = 0.6;          // m from the centre of a car to that of a car that it has passed
constexpr int max_passing_ticks = 120;  // a car may be blocked

/// Whether a body that does not drive lies ahead of the first car of a world, or beside it.
bool has_obstacle_near(const sim::World& world) {
  const sim::CarState& car = world.state(0);
  return std::ranges::any_of(bodies_of(world), [&](const Body& body) {
    const auto [ahead, aside] = maps::inverse_transform({car.x, car.y, car.yaw}, {body.pose.x, body.pose.y});
    return ahead > -behind && ahead < reach && std::abs(aside) < beside;
  });
}

}  // namespace

Session::Session(SessionOptions options, Server& server) : Playback(server), options_(std::move(options)) {
  install(options_.load(options_.scenario), options_.scenario);
  if (!options_.against.empty()) set_ghost(options_.against);
  state_.introduction = options_.introduction;
  slow_down();
}

/// Drives a scenario from its start, without a ghost.
void Session::install(LoadedScenario loaded, const ScenarioNames& names) {
  // Everything that may throw comes before anything is replaced.
  const evaluation::Driver driver{loaded.configuration, names.method};
  Drives drives{evaluation::LapDrive({loaded.environment, driver, loaded.lap}, names.seed)};
  facts_ = car_facts(loaded.environment.get());
  scene_ = shared(encode_scene(*facts_));
  loaded_ = std::move(loaded.configuration);
  loaded_texts_.clear();
  add_texts(loaded_texts_, sections_of(loaded_, names.method));
  state_.names = with_course(names, *loaded.environment);
  state_.bounds = bounds_of(facts_->course);
  undo_.clear();
  redo_.clear();
  server_.send(0, {scene_, true});
  begin(std::move(drives));
}

/// Drives again from the start with the same seed and the present drivers of car and ghost.
void Session::restart() {
  Drives drives{evaluation::LapDrive(setup(), state_.names.seed)};
  if (drives_->ghost) start_ghost(drives_->ghost_label, drives_->ghost->setup().driver)(drives);
  begin(std::move(drives));
}

void Session::begin(Drives drives) {
  Playback::begin(std::move(drives));
  state_.laps.clear();
  // Options can still be set back; the bodies of another world cannot.
  for (auto* changes : {&undo_, &redo_}) {
    std::erase_if(*changes, [](const Change& each) { return each.before.index() == 1; });
    for (Change& each : *changes) each.ticks = 0;
  }
  passing_ticks_ = -1;
  slow_down();
  are_options_changed_ = true;
}

void Session::drive_tick(bool is_shown) {
  pace_.step(control_period(), rate_);
  Drives& drives = *drives_;
  timeline_.checkpoint(drives);
  std::string ghost, frame;
  const Delays delays = state_.real_time ? last_updates_ : Delays{};
  const auto on_ghost = [&](const evaluation::ControlStep& step) {
    ghost = encode_ghost_frame(frame_of(*drives.ghost, step));
    last_updates_.ghost = step.output.tick_time;
  };
  const int number = drives.ticks();
  const auto on_car = [&](const evaluation::ControlStep& step) {
    frame = frame_of(drives.car, step) + ghost;
    last_updates_.car = step.output.tick_time;
  };
  drives.tick(delays, on_car, on_ghost);
  DrivenTick driven{number, delays, shared(std::move(frame))};
  driven.keep_scalars(scalars());
  timeline_.keep(std::move(driven));
  note_laps(drives.car, driver().method, false);
  if (drives.ghost) note_laps(*drives.ghost, drives.ghost_label, true);
  slow_down();
  if (is_shown) offer_newest();
}

std::string Session::frame_of(const evaluation::LapDrive& drive, const evaluation::ControlStep& step) const {
  const evaluation::Driver& driver = drive.setup().driver;
  return encode_car(*facts_, step, drive.setup().control_period(), driver.configuration.vehicle.time_step,
                    options_.choices.method_index(driver.method));
}

void Session::note_laps(const evaluation::LapDrive& drive, const std::string& method, bool is_ghost) {
  const sim::LapTimer& timer = *drive.world().laps(0);
  int laps = 0, contacts = 0;
  for (const LapNote& lap : state_.laps) {
    if (lap.ghost != is_ghost) continue;
    laps = lap.lap;
    contacts += lap.contacts;
  }
  if (timer.laps() <= laps) return;
  state_.laps.push_back({.tick = drive.steps(),
                         .lap = timer.laps(),
                         .time = timer.last_lap_time(),
                         .contacts = drive.collisions() - contacts,
                         .method = method,
                         .ghost = is_ghost});
  is_state_changed_ = true;
}

/// Keeps the introduction in slow motion until both cars have passed the obstacle.
void Session::slow_down() {
  if (!state_.introduction || passing_ticks_ > max_passing_ticks) return;
  const bool is_near = has_obstacle_near(drives_->world()) ||
                       (drives_->ghost && has_obstacle_near(std::as_const(*drives_->ghost).world()));
  if (is_near)
    ++passing_ticks_;
  else if (passing_ticks_ >= 0)
    passing_ticks_ = max_passing_ticks + 1;
  const bool is_over = passing_ticks_ > max_passing_ticks;
  const double rate = is_over ? 1 : passing_ticks_ >= 0 ? passing_rate : approaching_rate;
  is_state_changed_ = is_state_changed_ || rate != rate_;
  rate_ = rate;
}

/// Goes back for the first change after a pause, unless a change is shown there already.
bool Session::prepare_change() {
  const int ahead = held_ ? shown_tick() - held_->ticks() : -1;
  return (ahead >= 0 && ahead <= scan_lead) || approach(scan_lead);
}

void Session::forget_after(int tick, int ticks) {
  Playback::forget_after(tick, ticks);
  std::erase_if(state_.laps, [&](const LapNote& lap) { return lap.tick > tick + 1; });
  for (auto* changes : {&undo_, &redo_})
    std::erase_if(*changes, [&](const Change& each) { return each.ticks > ticks; });
  are_options_changed_ = true;
}

/// Applies actions to the drives, from the tick that is shown on. While nothing moves, this tick is driven
/// again, so that the plan that is shown belongs to the change. The scan of a tick was taken at the end of
/// the tick before; a change of what it sees therefore has the `lead` 1: both are driven again. If an action
/// throws, nothing has changed.
void Session::perform(const std::vector<Action>& actions, int lead) {
  const bool is_driven_again = is_held();
  const int shown = shown_tick();
  Drives drives = present(lead);
  for (const Action& each : actions) each(drives);
  acted_ = drives.ticks();
  drives_ = std::move(drives);
  if (is_driven_again) forget_after(acted_ - 1, shown);
  for (const Action& each : actions) timeline_.note(acted_, each);
  is_state_changed_ = are_options_changed_ = true;
  if (!is_driven_again) return;
  held_ = *drives_;
  const Clock::time_point due = pace_.due;
  if (acted_ < shown) {
    drive_tick(false);
    timeline_.act(*drives_);
  }
  tick();
  pace_.due = due;
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

}  // namespace slalom::view
