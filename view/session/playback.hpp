#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "view/server/audience.hpp"
#include "view/session/pace.hpp"
#include "view/session/timeline.hpp"

namespace slalom::view {

/// Drives for the pages that are open: the drive pauses, goes back to any stored step and continues from
/// there. `Drives` is as TimelineOf wants it. Everything happens in the thread that calls `turn`, which never
/// waits for a client.
template <class Drives>
class Playback {
 public:
  explicit Playback(Server& server) : server_(server), audience_(server) {}
  virtual ~Playback() = default;

  /// Executes the commands that have come, and drives one step if it is due; waits for one, for `at_most` at
  /// most.
  void turn(std::chrono::nanoseconds at_most = {}) {
    const auto wait =
        is_prepared_ ? std::min<Clock::duration>(until_due(), at_most) : Clock::duration::zero();
    if (wait > Clock::duration::zero()) server_.wait(wait);
    audience_.turn(
        [this](auto client) { join(client); },
        [this](auto client, const auto& what, const Json& command) { obey(client, what, command); });
    if (until_due() <= Clock::duration::zero()) {
      if (steps_left_ > 0) --steps_left_;
      tick();
    }
    is_prepared_ = !(paused_ && is_held()) || prepare_change();
    const auto now = Clock::now();
    if (server_.clients() == 0 || !(is_state_changed_ || now - last_state_ > max_state_gap)) return;
    last_state_ = now;
    is_state_changed_ = false;
    measured_rate_ = pace_.measure(measured_rate_, control_period(), paused_);
    tell();
  }

 protected:
  using Clock = Pace::Clock;
  using Json = nlohmann::ordered_json;
  using Timeline = TimelineOf<Drives>;

  virtual double control_period() const = 0;  ///< s
  virtual std::size_t scalars() const = 0;    ///< number of figures with which a frame begins
  virtual void join(std::uint64_t client) = 0;
  virtual void obey(std::uint64_t client, const std::string& what, const Json& command) = 0;
  virtual void tick() = 0;     ///< drives one step
  virtual void restart() = 0;  ///< drives again from the start
  virtual void tell() = 0;     ///< tells all pages the state, and the options if they have changed
  /// Does a part of the work that the first change after a pause would wait for. Returns whether all is done.
  virtual bool prepare_change() { return approach(0); }
  virtual Packing packing() const { return {}; }  ///< form of stored frames

  /// Executes the commands that concern time, and those that pages may give that watch; false for others.
  /// Throws std::invalid_argument unless the client drives.
  bool obey_transport(std::uint64_t client, const std::string& what, const Json& command) {
    if (what == "past") {
      const int from = field::integer(command, "from"), to = field::integer(command, "to");
      server_.send(client, {shared(timeline_.past(from, to)), true});
      return true;
    }
    if (what == "take_over") {
      audience_.take_over(client);
      return true;
    }
    audience_.require_driver(client);
    is_state_changed_ = true;
    if (what == "pause") {
      if (!paused_ && timeline_.is_action_due()) tick();
      paused_ = true;
      steps_left_ = 0;
      publish_newest();
    } else if (what == "play" || what == "step") {
      const int steps = what == "step" ? field::steps(command) : 0;
      continue_from_shown();
      waiting_ = false;
      paused_ = steps > 0;
      steps_left_ = paused_ ? std::min(steps_left_ + steps, field::max_steps) : 0;
      pace_ = {};
    } else if (what == "seek") {
      show_step(field::integer(command, "tick"));
    } else if (what == "rate") {
      rate_ = field::rate(command);
      pace_.due = Clock::now();
    } else if (what == "restart") {
      paused_ = false;
      restart();
    } else {
      return false;
    }
    return true;
  }

  /// Begins with other drives, without a past.
  void begin(Drives drives) {
    drives_ = std::move(drives);
    timeline_ = Timeline(control_period(), packing());
    held_.reset();
    viewed_ = -1;
    steps_left_ = 0;
    ++generation_;
    pace_ = {};
    is_state_changed_ = true;
  }

  Clock::duration until_due() const {
    if (steps_left_ > 0) return Clock::duration::zero();
    if (waiting_ || paused_) return std::chrono::hours(1);
    return pace_.until_due(rate_);
  }
  int shown_tick() const { return viewed_ >= 0 ? viewed_ : timeline_.newest(); }
  /// Whether a change is to be shown before the next step: the drive is paused, or in slow motion.
  bool is_held() const {
    return (paused_ || Pace::is_slow(control_period(), rate_)) && steps_left_ == 0 && !timeline_.empty();
  }
  /// Returns the drives that a change applies to. While nothing moves these are the drives when the step that
  /// is shown began, or with `lead` the step before it; else the present ones.
  const Drives& present(int lead = 0) {
    if (!is_held()) return *drives_;
    while (!approach(lead)) continue;
    return *held_;
  }

  /// Brings `held_` one step nearer to what `present` returns; true if it is there.
  bool approach(int lead) {
    return timeline_.approach(held_, std::max(shown_tick() - lead, timeline_.oldest()));
  }

  /// Makes the step that is shown the newest one.
  void continue_from_shown() {
    if (viewed_ < 0) return;
    present();
    drives_ = std::move(*std::exchange(held_, std::nullopt));
    drives_->tick(timeline_.at(viewed_).delays);
    forget_after(viewed_, viewed_);
    pace_.due = Clock::now();
  }
  /// Forgets what was driven after a step, and what was changed after `ticks` steps.
  virtual void forget_after(int tick, int ticks) {
    timeline_.forget_after(tick, ticks);
    viewed_ = -1;
    is_state_changed_ = true;
  }

  /// Pauses and shows a stored step.
  void show_step(int tick) {
    steps_left_ = 0;
    if (timeline_.empty()) return;
    tick = std::clamp(tick, timeline_.oldest(), timeline_.newest());
    viewed_ = tick == timeline_.newest() ? -1 : tick;
    paused_ = is_newest_sent_ = is_state_changed_ = true;
    server_.publish(0, timeline_.frame(tick));
  }
  /// Sends the frame of a step that was just driven, unless the last one was sent a moment ago.
  void offer_newest() {
    is_newest_sent_ = false;
    if (paused_ || Clock::now() - last_frame_ >= min_frame_gap) publish_newest();
  }
  void publish_newest() {
    if (std::exchange(is_newest_sent_, true) || timeline_.empty()) return;
    last_frame_ = Clock::now();
    server_.publish(0, timeline_.frame(timeline_.newest()));
  }

  Server& server_;
  Audience audience_;
  std::optional<Drives> drives_;
  Timeline timeline_;
  std::optional<Drives> held_;  ///< while nothing moves: what a change last applied to, with the change
  Pace pace_;
  double rate_ = 1, measured_rate_ = 0;  ///< simulated to real time; 0: as fast as possible, not known
  bool paused_ = false, is_state_changed_ = true;
  bool waiting_ = true;         ///< for the first page to be opened
  bool is_prepared_ = true;     ///< whether a change after a pause need not wait
  bool is_newest_sent_ = true;  ///< false if the newest step came too early for a frame
  int viewed_ = -1;             ///< step that is shown while it is not the newest
  int steps_left_ = 0;          ///< steps of a command "step" that are still to come
  int generation_ = 0;          ///< number of drives that have begun
  Clock::time_point last_state_ = Clock::now(), last_frame_ = last_state_;
};

}  // namespace slalom::view
