
#include "json/json.hpp"
#include "view/session/session.hpp"

namespace slalom::view {

void Session::turn(std::chrono::nanoseconds at_most) {
  const auto wait = is_prepared_ ? std::min<Clock::duration>(until_due(), at_most) : Clock::duration::zero();
  if (wait > Clock::duration::zero()) server_.wait(wait);
  audience_.turn([this](auto client) { join(client); },
                 [this](auto client, const auto& what, const Json& command) { obey(client, what, command); });
  if (until_due() <= Clock::duration::zero()) {
    if (steps_left_ > 0) --steps_left_;
    tick();
  }
  is_prepared_ = !(state_.paused && is_held()) || prepare_change();
  const auto now = Clock::now();
  if (server_.clients() == 0 || !(is_state_changed_ || now - last_state_ > max_state_gap)) return;
  last_state_ = now;
  is_state_changed_ = false;
  state_.pace = pace_.measure(state_.pace, control_period(), state_.paused);
  tell();
}

/// Executes the commands that concern time; false for others.
bool Session::obey_transport(const std::string& what, const Json& command) {
  if (what == "pause") {
    if (!state_.paused && timeline_.is_action_due()) tick();
    state_.paused = true;
    steps_left_ = 0;
    publish_newest();
  } else if (what == "play") {
    continue_from_shown();
    state_.paused = waiting_ = false;
    steps_left_ = 0;
    pace_ = {};
  } else if (what == "step") {
    int steps = field::steps(command);
    if (viewed_ >= 0) {  // driven steps are shown, not driven again
      const int shown = std::min(steps, timeline_.newest() - viewed_);
      show_step(viewed_ + shown);
      steps -= shown;
    }
    waiting_ = false;
    state_.paused = true;
    steps_left_ = std::min(steps_left_ + steps, field::max_steps);
    pace_ = {};
  } else if (what == "seek") {
    show_step(field::integer(command, "tick"));
  } else if (what == "rate") {
    state_.rate = field::rate(command);
    pace_.due = Clock::now();
  } else if (what == "restart") {
    state_.paused = false;
    begin(drives_->restarted());
  } else {
    return false;
  }
  return true;
}

Session::Clock::duration Session::until_due() const {
  if (steps_left_ > 0) return Clock::duration::zero();
  if (waiting_ || state_.paused) return std::chrono::hours(1);
  return pace_.until_due(state_.rate);
}

/// Whether a change is to be shown before the next step: the drive is paused, or in slow motion.
bool Session::is_held() const {
  return (state_.paused || Pace::is_slow(control_period(), state_.rate)) && steps_left_ == 0 &&
         !timeline_.empty();
}

/// Returns the drives that a change applies to. While nothing moves these are the drives when the step that
/// is shown began, or with `lead` the step before it; else the present ones.
Drives& Session::present(int lead) {
  if (!is_held()) return *drives_;
  while (!approach(lead)) continue;
  return *held_;
}

/// Brings `held_` one step nearer to what `present` returns; true if it is there.
bool Session::approach(int lead) {
  return timeline_.approach(held_, std::max(shown_tick() - lead, timeline_.oldest()));
}

/// Does a part of the work that the first change after a pause would wait for, unless a change is shown there
/// already. Returns whether all is done.
bool Session::prepare_change() {
  const int lead = facts().scans_ahead;
  const int ahead = held_ ? shown_tick() - held_->ticks() : -1;
  return (ahead >= 0 && ahead <= lead) || approach(lead);
}

/// Makes the step that is shown the newest one.
void Session::continue_from_shown() {
  if (viewed_ < 0) return;
  present();
  drives_ = std::move(*std::exchange(held_, std::nullopt));
  drives_->tick(timeline_.at(viewed_).records);
  forget_after(viewed_, viewed_);
  pace_.due = Clock::now();
}

/// Forgets what was driven after a step, and what was changed after `ticks` steps.
void Session::forget_after(int tick, int ticks) {
  timeline_.forget_after(tick, ticks);
  viewed_ = -1;
  is_state_changed_ = true;
  for (auto* changes : {&undo_, &redo_})
    std::erase_if(*changes, [&](const Change& each) { return each.ticks > ticks; });
}

/// Pauses and shows a stored step.
void Session::show_step(int tick) {
  steps_left_ = 0;
  if (timeline_.empty()) return;
  tick = std::clamp(tick, timeline_.oldest(), timeline_.newest());
  viewed_ = tick == timeline_.newest() ? -1 : tick;
  state_.paused = is_newest_sent_ = is_state_changed_ = true;
  server_.publish(0, timeline_.frame(tick));
}

/// Sends the frame of a step that was just driven, unless the last one was sent a moment ago.
void Session::offer_newest() {
  is_newest_sent_ = false;
  if (state_.paused || Clock::now() - last_frame_ >= min_frame_gap) publish_newest();
}

void Session::publish_newest() {
  if (std::exchange(is_newest_sent_, true) || timeline_.empty()) return;
  last_frame_ = Clock::now();
  server_.publish(0, timeline_.frame(timeline_.newest()));
}

}  // namespace slalom::view
