#include "tracking/manoeuvres.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::tracking {
namespace {

constexpr double max_across = 1.0;  // rad, between an object's yaw and the course
constexpr double min_ratio = 0.15,
                 max_ratio = 1.5;    // bounds of the ratio of the speed to the course's that is kept
constexpr double usual_drift = 0.3;  // m/s, standard deviation of drifts among objects
constexpr double max_piece = 0.1;    // s, of an integration

}  // namespace

Motion motion_of(const TrackedObject& object, const CourseLine& course,
                 const PredictorOptions& options) noexcept {
  Motion motion{.pose = object.pose, .speed = object.speed, .yaw_rate = object.yaw_rate};
  if (course.empty()) return motion;
  const CourseLine::Place place = course.project(object.pose);
  const double across = maps::wrap_angle(object.pose.yaw - course.at(place.arc).yaw);
  if (std::abs(place.offset) > options.max_offset || std::abs(across) > max_across) return motion;
  motion.on_course = true;
  motion.arc = place.arc;
  motion.offset = place.offset;
  motion.speed = object.speed * std::cos(across);
  // The drift that is expected, given the error of the yaw.
  const double variance = object.speed * object.speed * object.covariance[2][2];
  motion.drift =
      object.speed * std::sin(across) * usual_drift * usual_drift / (usual_drift * usual_drift + variance);
  return motion;
}

void Way::advance(double duration) noexcept {
  const int pieces = std::max(saturate_cast<int>(std::ceil(duration / max_piece - 1e-9)), 1);
  const double piece = duration / pieces;
  for (int i = 0; i < pieces; ++i) {
    if (now_.on_course) {
      advance_on_course(piece);
      continue;
    }
    const double before = now_.speed;
    if (manoeuvre_ == Manoeuvre::brake) now_.speed = std::max(before - options_.braking * piece, 0.0);
    const double way = 0.5 * (before + now_.speed) * piece;
    const double yaw = now_.pose.yaw + 0.5 * now_.yaw_rate * piece;
    now_.pose.x += way * std::cos(yaw);
    now_.pose.y += way * std::sin(yaw);
    now_.pose.yaw =
        maps::wrap_angle(now_.pose.yaw + now_.yaw_rate * piece * (before > 0 ? now_.speed / before : 0));
  }
}

void Way::advance_on_course(double duration) noexcept {
  time_ += duration;
  if (manoeuvre_ == Manoeuvre::repeat) return repeat(duration);
  const double before = now_.speed;
  if (manoeuvre_ == Manoeuvre::brake) {
    now_.speed = std::max(before - options_.braking * duration, 0.0);
  } else {
    // The course is slow where it turns, and so is everybody on it.
    const double there = course_.at(start_.arc).speed;
    const double ratio = there > 0 ? start_.speed / there : 0;
    const double next = course_.at(now_.arc + before * duration).speed;
    const double risen = std::min(ratio + start_.rise * time_, std::max(ratio, 1.0));
    if (ratio > min_ratio && ratio < max_ratio && next > 0) now_.speed = risen * next;
  }
  const double widening = std::max(1 - now_.offset * course_.at(now_.arc).curvature, 0.2);
  now_.arc += 0.5 * (before + now_.speed) * duration / widening;
  // The offset goes to its aim like a critically damped oscillator; kept, the drift dies away.
  const double rate = 1 / options_.reaction, fading = std::exp(-rate * time_);
  if (manoeuvre_ == Manoeuvre::keep || manoeuvre_ == Manoeuvre::brake) {
    now_.offset = start_.offset + start_.drift * options_.reaction * (1 - fading);
    now_.drift = start_.drift * fading;
    return;
  }
  const double step = manoeuvre_ == Manoeuvre::left ? options_.side_step : -options_.side_step;
  const double aim = manoeuvre_ == Manoeuvre::follow ? 0 : start_.offset + step;
  const double away = start_.offset - aim, slope = start_.drift + rate * away;
  now_.offset = aim + (away + slope * time_) * fading;
  now_.drift = (slope - rate * (away + slope * time_)) * fading;
}

/// Drives as cars drove here before. What differs from them at the start fades.
void Way::repeat(double duration) noexcept {
  const double before = now_.speed, fading = std::exp(-time_ / options_.reaction);
  const double there = course_.at(start_.arc).speed;
  const double next = now_.arc + before * duration;
  const Habits::Habit habit = habits_.at(next);
  if (habit.ratio > 0 && start_.habit.ratio > 0 && there > 0) {
    const double share = start_.speed / (there * start_.habit.ratio);
    now_.speed = habit.ratio * (1 + (share - 1) * fading) * course_.at(next).speed;
    const double offset = habit.offset + (start_.offset - start_.habit.offset) * fading;
    now_.drift = (offset - now_.offset) / duration;
    now_.offset = offset;
  }
  const double widening = std::max(1 - now_.offset * course_.at(now_.arc).curvature, 0.2);
  now_.arc += 0.5 * (before + now_.speed) * duration / widening;
}

maps::Pose Way::pose() const noexcept {
  if (!now_.on_course) return now_.pose;
  const CourseLine::Point at = course_.at(now_.arc);
  const double turned = std::atan2(now_.drift, std::max(now_.speed, 0.5));
  return {at.x - now_.offset * std::sin(at.yaw), at.y + now_.offset * std::cos(at.yaw), at.yaw + turned};
}

}  // namespace slalom::tracking
