#include "slalom/maps/recovery.hpp"

#include <algorithm>

#include "slalom/maps/body_room.hpp"

namespace slalom::maps {
namespace {

constexpr double crawling = 0.4;    // share of the free speed: a slower vehicle crawls
constexpr double hesitation = 0.5;  // s of crawling, after which plans are urgent
constexpr double growth = 1.6;      // times as far in reverse, each further time

/// The distance (m) from one place to another along the way.
double way_between(double from, double to, double closed_length) {
  return closed_length > 0 ? std::remainder(to - from, closed_length) : to - from;
}

}  // namespace

RecoveryLengths RecoveryLengths::of(double body_length) noexcept {
  const double scale = body_scale(body_length), root = std::sqrt(scale);
  return {.progress = 0.5 * scale,
          .relief = 4 * scale,
          .shortest = 0.8 * scale,
          .longest = 3 * scale,
          .jump = 10 * scale,
          .standing = 0.15 * root,
          .reverse = 0.45 * root};
}

Recovery::StandingLimit Recovery::standing_limit(DriveState state) const noexcept {
  const DriveState back = lengths_.longest > 0 ? DriveState::reversing : DriveState::retrying;
  switch (state) {
    case DriveState::waiting:
      return {lengths_.wait, DriveState::retrying};
    case DriveState::reversing:
      return {lengths_.stand_still, DriveState::retrying};
    case DriveState::manoeuvring:
      return {2 * lengths_.patience, DriveState::retrying};
    case DriveState::stuck:
      return {lengths_.wait, DriveState::retrying};
    default:
      return {lengths_.stand_still, back};
  }
}

void Recovery::enter(DriveState state) noexcept {
  state_ = state;
  standing_ = in_state_ = 0;
}

void Recovery::watch_from(double arc) noexcept {
  if (reverses()) enter(DriveState::retrying);
  furthest_ = arc;
  since_progress_ = standing_ = crawling_ = 0;
}

void Recovery::end_manoeuvre(double arc) noexcept {
  enter(retries_ ? DriveState::retrying : DriveState::following);
  watch_from(arc);
}

DriveState Recovery::update(const Seen& seen, double period) noexcept {
  if (!started_) furthest_ = seen.arc, started_ = true;
  in_state_ += period;
  begins_ = false;
  const bool stands = std::abs(seen.speed) < lengths_.standing;
  standing_ = stands ? standing_ + period : 0;
  const bool crawls = seen.speed < crawling * seen.free_speed || seen.speed < lengths_.standing;
  crawling_ = crawls && !reverses() && !seen.waits ? crawling_ + period : 0;
  if (state_ == DriveState::reversing) {
    reverse(seen, period);
  } else if (state_ != DriveState::manoeuvring && state_ != DriveState::stuck) {
    watch(seen, period);
  } else if (standing_ >= standing_limit(state_).time) {
    attempts_ = 0;
    try_again(seen);
    watch_from(seen.arc);
  }
  return state_;
}

/// Watches a vehicle that drives along its way, and decides whether it must do something else.
void Recovery::watch(const Seen& seen, double period) noexcept {
  note_progress(seen, period);
  // Past the places of trouble, everything is as usual again.
  if (leaving_ && way_between(trouble_, seen.arc, seen.closed_length) > lengths_.relief) {
    leaving_ = confined_ = false;
    distance_ = lengths_.shortest;
  }
  if (retries_ && way_between(tried_at_, seen.arc, seen.closed_length) > lengths_.relief) {
    retries_ = false;
    attempts_ = 0;
  }
  const DriveState usual = seen.waits ? DriveState::waiting
                           : retries_ ? DriveState::retrying
                                      : DriveState::following;
  if (usual != state_) enter(usual);
  const bool no_progress = since_progress_ >= lengths_.patience;
  if (crawling_ >= hesitation || no_progress) {
    if (!leaving_ || way_between(trouble_, seen.arc, seen.closed_length) > 0) trouble_ = seen.arc;
    leaving_ = true;
  }
  if (no_progress || standing_ >= standing_limit(state_).time) try_again(seen);
}

void Recovery::note_progress(const Seen& seen, double period) noexcept {
  const double way = way_between(furthest_, seen.arc, seen.closed_length);
  const bool was_moved = std::abs(way) > lengths_.jump, progresses = way > lengths_.progress;
  if (was_moved) leaving_ = retries_ = confined_ = false;
  since_progress_ = was_moved ? period : progresses || seen.waits ? 0 : since_progress_ + period;
  if (was_moved || progresses) furthest_ = seen.arc;
}

/// Reverses or takes another way, after a time without progress.
void Recovery::try_again(const Seen& seen) noexcept {
  if (!retries_ || way_between(tried_at_, seen.arc, seen.closed_length) > 0) tried_at_ = seen.arc;
  retries_ = begins_ = true;
  driven_ = since_progress_ = 0;
  const bool has_tried = state_ == DriveState::following || state_ == DriveState::retrying;
  if (has_tried) ++attempts_;
  enter(attempts_ >= lengths_.attempts ? DriveState::stuck : standing_limit(state_).next);
}

void Recovery::reverse(const Seen& seen, double period) noexcept {
  driven_ += std::max(-seen.speed, 0.0) * period;
  const bool gets_on = driven_ < (seen.is_free ? 0.5 : 1) * distance_ &&
                       standing_ < standing_limit(DriveState::reversing).time && in_state_ < lengths_.wait;
  if (gets_on) return;
  confined_ |= driven_ < lengths_.shortest / 8;
  distance_ = std::min(growth * distance_, lengths_.longest);
  watch_from(seen.arc);
}

}  // namespace slalom::maps
