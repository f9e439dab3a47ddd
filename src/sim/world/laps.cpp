#include "slalom/sim/laps.hpp"

#include <algorithm>

#include "slalom/core/options.hpp"
#include "slalom/maps/reference_path.hpp"

namespace slalom::sim {

LapPath::LapPath(std::vector<maps::Point> points) : points_(std::move(points)) {
  using slalom::detail::check;
  check("lap path", {"points", "", "", 3}, points_.size());
  double arc = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    check("lap path", {"x", "m", "", -1e9, 1e9}, points_[i].x);
    check("lap path", {"y", "m", "", -1e9, 1e9}, points_[i].y);
    start_.push_back(arc);
    const maps::Point& next = points_[i + 1 == points_.size() ? 0 : i + 1];
    arc += std::hypot(next.x - points_[i].x, next.y - points_[i].y);
  }
  start_.push_back(arc);
  check("lap path", {"length", "m", "", 1e-9}, arc);
}

LapPath::Place LapPath::place(const maps::Point& p, std::size_t i) const noexcept {
  const maps::Point a = points_[i], b = points_[i + 1 == points_.size() ? 0 : i + 1];
  const double length = start_[i + 1] - start_[i], dx = b.x - a.x, dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;
  const double t = squared > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
  const double ex = p.x - (a.x + t * dx), ey = p.y - (a.y + t * dy);
  const double distance = std::hypot(ex, ey);
  double arc = start_[i] + t * length;
  if (arc >= start_.back()) arc = 0;
  return {i, arc, dx * ey - dy * ex >= 0 ? distance : -distance, distance};
}

LapPath::Place LapPath::project(const maps::Pose& pose) const noexcept {
  const maps::Point here{pose.x, pose.y};
  const std::size_t count = points_.size();
  const auto squared_to = [&](std::size_t i) { return std::pow(place(here, i).distance, 2); };
  const auto turned = [&](std::size_t i) {
    const maps::Point &a = points_[i], &b = points_[i + 1 == count ? 0 : i + 1];
    return pose.yaw - std::atan2(b.y - a.y, b.x - a.x);
  };
  return place(here, maps::place_on_path(count, squared_to, turned, count));
}

LapPath::Place LapPath::project_near(const maps::Point& p, std::size_t near, double reach) const noexcept {
  const std::size_t count = points_.size();
  Place best = place(p, near);
  for (const std::size_t onwards : {std::size_t{1}, count - 1}) {
    double way = 0;
    for (std::size_t k = 1, i = near; k < count && way < reach; ++k) {
      i = (i + onwards) % count;
      if (const Place here = place(p, i); here.distance < best.distance) best = here;
      way += start_[i + 1] - start_[i];
    }
  }
  return best;
}

maps::Pose LapPath::at(double arc) const noexcept {
  double s = std::fmod(arc, length());
  if (s < 0) s += length();
  const auto after = std::upper_bound(start_.begin(), start_.end() - 1, s);
  const auto i = static_cast<std::size_t>(after - start_.begin()) - 1;
  const maps::Point a = points_[i], b = points_[i + 1 == points_.size() ? 0 : i + 1];
  const double t = (s - start_[i]) / (start_[i + 1] - start_[i]);
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), std::atan2(b.y - a.y, b.x - a.x)};
}

void LapTimer::reset(const LapPath& path, const maps::Pose& pose, double time) noexcept {
  place_ = path.project(pose);
  progress_ = 0;
  time_ = lap_start_ = time;
  last_lap_time_ = 0;
  laps_ = 0;
}

void LapTimer::update(const LapPath& path, const maps::Point& position, double time) noexcept {
  // Near is what a car reaches in a step, many times over, and less than the way to another part of a course.
  constexpr double reach = 2.0;
  const LapPath::Place now = path.project_near(position, place_.segment, reach);
  const double length = path.length();
  const double moved = std::remainder(now.arc - place_.arc, length);
  const double before = progress_, time_before = time_;
  place_ = now;
  time_ = time;
  progress_ += moved;
  while (moved > 0 && progress_ >= length * (laps_ + 1.0)) {
    const double part = std::clamp((length * (laps_ + 1.0) - before) / moved, 0.0, 1.0);
    const double crossed = time_before + part * (time - time_before);
    last_lap_time_ = crossed - lap_start_;
    lap_start_ = crossed;
    ++laps_;
  }
}

void StartZoneLaps::reset(const maps::Point& own, double heading) noexcept {
  start_ = own;
  cosine_ = std::cos(-heading);
  sine_ = std::sin(-heading);
  near_ = true;
  toggles_ = 0;
  time_ = 0;
}

void StartZoneLaps::update(const maps::Point& position, double time) noexcept {
  constexpr double half_width = 2, depth_squared = 0.1;  // m, m^2
  const double dx = position.x - start_.x, dy = position.y - start_.y;
  const double along = cosine_ * dx - sine_ * dy, across = sine_ * dx + cosine_ * dy;
  const double beyond = std::max(std::abs(across) - half_width, 0.0);
  const bool close = along * along + beyond * beyond <= depth_squared;
  toggles_ += close != near_;
  near_ = close;
  if (toggles_ < 4) time_ = time;
}

}  // namespace slalom::sim
