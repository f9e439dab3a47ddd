#include "slalom/maps/path_curve.hpp"

#include <algorithm>

namespace slalom::maps {

namespace {

constexpr double behind = 0.3, ahead = 1;        // m, where the nearest point is searched
constexpr double as_close = 0.1;                 // m, difference of distances that does not count
constexpr double corner = std::numbers::pi / 3;  // rad
constexpr std::size_t corner_points = 2;         // points to each side between which a corner is measured
constexpr double least_turn = 0.05;              // rad at the goal

Point position(const Pose& pose) {
  return {pose.x, pose.y};
}

double direction(const Pose& from, const Pose& to) {
  return std::atan2(to.y - from.y, to.x - from.x);
}

}  // namespace

void PathCurve::reserve(std::size_t count) {
  points_.reserve(count);
  backward_.reserve(count);
  legs_.reserve(count);
}

void PathCurve::clear() noexcept {
  points_.clear();
  backward_.clear();
  legs_.clear();
  nearest_ = leg_ = 0;
}

/// Points at a constant distance along the poses, and the direction of travel from each on.
void PathCurve::resample(std::span<const Pose> poses) noexcept {
  const auto at = [&](std::size_t i) { return poses[std::min(i, poses.size() - 1)]; };
  const auto edge = [&](std::size_t i) { return distance(position(at(i)), position(at(i + 1))); };
  double length = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) length += edge(i);
  const auto parts = saturate_cast<std::size_t>(std::max(2.0, std::ceil(length / spacing)));
  step_ = length / static_cast<double>(parts);
  std::size_t segment = 0;
  double begin = 0, here = edge(0);
  for (std::size_t k = 0; k < parts; ++k) {
    const double along = step_ * static_cast<double>(k);
    while (begin + here <= along && segment + 2 < poses.size()) {
      begin += here;
      here = edge(++segment);
    }
    const Pose a = at(segment), b = at(segment + 1);
    const double share = here > 0 ? std::min((along - begin) / here, 1.0) : 0;
    points_.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.yaw});
    backward_.push_back(here > 0 && std::cos(a.yaw - direction(a, b)) < 0);
  }
  points_.push_back(goal_);
  backward_.push_back(backward_.back());
}

/// The change of the direction of travel at a point, rad.
double PathCurve::turn_at(std::size_t i) const noexcept {
  const std::size_t before = i > corner_points ? i - corner_points : 0,
                    after = std::min(i + corner_points, points_.size() - 1);
  return std::abs(wrap_angle(direction(points_[i], points_[after]) - direction(points_[before], points_[i])));
}

/// Whether a leg ends at a point: the direction of travel changes there, or it is a corner's sharpest point.
bool PathCurve::is_boundary(std::size_t i, bool turns_on_the_spot) const noexcept {
  if (backward_[i] != backward_[i - 1]) return true;
  if (!turns_on_the_spot) return false;
  const double turn = turn_at(i);
  if (turn < corner) return false;
  const std::size_t first = i > corner_points ? i - corner_points : 1,
                    last = std::min(i + corner_points, points_.size() - 2);
  for (std::size_t k = first; k <= last; ++k) {
    if (backward_[k] != backward_[k - 1]) return false;
    if (k < i ? turn_at(k) >= turn : turn_at(k) > turn) return false;
  }
  return true;
}

/// Moves a point to the given pose within a step at which the direction changes most; of equal ones, to the
/// nearest along the path. `before` is a pose further back, from which the next point begins, too.
void PathCurve::snap(std::size_t i, std::span<const Pose> poses, Reached& before) noexcept {
  const double wanted = step_ * static_cast<double>(i);
  double best = -1;
  for (Reached at = before; at.way <= wanted + step_;) {
    if (at.way < wanted - step_) before = at;
    const std::size_t k = at.pose;
    std::size_t next = k + 1;  // beyond poses at the same position
    while (next < poses.size() && distance(position(poses[k]), position(poses[next])) == 0) ++next;
    const bool ends = next >= poses.size();
    const double after = ends ? at.direction : direction(poses[k], poses[next]);
    const double turn = k > 0 ? std::abs(wrap_angle(after - at.direction)) : 0,
                 off = std::abs(at.way - wanted) / step_;
    if (off <= 1 && turn + 0.1 * (1 - off) > best) {
      best = turn + 0.1 * (1 - off);
      points_[i].x = poses[k].x;
      points_[i].y = poses[k].y;
    }
    if (ends) break;
    at = {next, at.way + distance(position(poses[k]), position(poses[next])), after};
  }
}

/// Adds the leg to a point, with the yaws on it, and before it the turn into its direction.
void PathCurve::add_leg(std::size_t first, std::size_t last, bool turns_on_the_spot) noexcept {
  const bool backward = backward_[first] != 0;
  for (std::size_t i = first; i < last; ++i)
    if (step_ > 0)
      points_[i].yaw = wrap_angle(direction(points_[i], points_[i + 1]) + (backward ? std::numbers::pi : 0));
  const double begin = points_[first].yaw;
  if (turns_on_the_spot && !legs_.empty() && std::abs(wrap_angle(begin - legs_.back().yaw)) > 0.5 * corner)
    legs_.push_back({first, first, backward, true, begin});
  legs_.push_back({first, last, backward, false, points_[last - 1].yaw});
}

void PathCurve::set(std::span<const Pose> poses, bool turns_on_the_spot, double smooth) noexcept {
  clear();
  goal_ = poses.back();
  resample(poses);
  const std::size_t last = points_.size() - 1;
  if (step_ == 0 && turns_on_the_spot) {
    legs_.push_back({last, last, false, true, goal_.yaw});
    return;
  }
  std::size_t first = 0;
  Reached before;
  for (std::size_t i = 1; i < last; ++i) {
    if (step_ == 0 || !is_boundary(i, turns_on_the_spot && step_ * static_cast<double>(i) > smooth)) continue;
    snap(i, poses, before);
    add_leg(first, i, turns_on_the_spot);
    first = i;
  }
  add_leg(first, last, turns_on_the_spot);
  points_.back().yaw = legs_.back().yaw;
  if (turns_on_the_spot && std::abs(wrap_angle(goal_.yaw - legs_.back().yaw)) > least_turn)
    legs_.push_back({last, last, legs_.back().backward, true, goal_.yaw});
}

void PathCurve::turn_first(double yaw) noexcept {
  legs_.insert(legs_.begin() + static_cast<std::ptrdiff_t>(leg_),
               {nearest_, nearest_, leg().backward, true, yaw});
}

void PathCurve::next_leg() noexcept {
  if (on_last_leg()) return;
  nearest_ = legs_[++leg_].first;
}

bool PathCurve::join_legs() noexcept {
  const auto at = legs_.begin() + static_cast<std::ptrdiff_t>(leg_);
  if (legs_.end() - at < 3 || !at[1].turns || at[2].turns || at->backward != at[2].backward) return false;
  at->last = at[2].last;
  at->yaw = at[2].yaw;
  legs_.erase(at + 1, at + 3);
  return true;
}

void PathCurve::place(const Point& vehicle) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const Pose& point : points_) least = std::min(least, distance(vehicle, position(point)));
  std::size_t i = 0;
  while (distance(vehicle, position(points_[i])) > least + as_close) ++i;
  // From the first point that is close, to the nearest one there.
  while (i + 1 < points_.size() &&
         distance(vehicle, position(points_[i + 1])) <= distance(vehicle, position(points_[i])))
    ++i;
  nearest_ = i;
  leg_ = 0;
  while (!on_last_leg() && (leg().turns || leg().last <= nearest_)) ++leg_;
}

void PathCurve::advance(const Point& vehicle) noexcept {
  const double step = std::max(step_, 1e-3);
  const auto back = saturate_cast<std::size_t>(behind / step),
             forth = saturate_cast<std::size_t>(ahead / step);
  const std::size_t first = std::max(leg().first, nearest_ > back ? nearest_ - back : 0),
                    last = std::min(leg().last, nearest_ + forth);
  nearest_ = std::clamp(nearest_, first, last);
  double least = distance(vehicle, position(points_[nearest_]));
  for (std::size_t i = first; i <= last; ++i) {
    const double here = distance(vehicle, position(points_[i]));
    if (here >= least) continue;
    least = here;
    nearest_ = i;
  }
}

}  // namespace slalom::maps
