#include "navigation/leg_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "navigation/manoeuvre.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr double wrong_way = std::numbers::pi / 3;  // rad from the path, from which the robot first turns
constexpr double turn_done = 0.2;        // rad from the end of a turn, at which the next leg begins
constexpr double turn_step = 0.1;        // rad between the poses of a turn that are checked
constexpr double direction_ahead = 0.3;  // m of path whose direction a first turn takes
constexpr double longest_change = 3;     // m of path that a manoeuvre may replace
constexpr int join_stride = 2;           // points between the places where a manoeuvre may join the path
constexpr double wider = 1.1;            // times the least radius, of manoeuvres
constexpr double settled = 0.5;          // s of standing near the end of a leg, after which it is finished

bool stands(const Velocity& v) {
  return std::hypot(v.forward, v.left) < 0.02 && std::abs(v.turn) < 0.05;
}

}  // namespace

/// Whether the body is free while the robot turns on the spot.
bool LegChange::is_free(const maps::Pose& robot, double turn, const Costmap& costmap) const noexcept {
  const int steps = saturate_cast<int>(std::ceil(std::abs(turn) / turn_step));
  for (int i = 1; i <= steps; ++i)
    if (costmap.collides(footprint_, {robot.x, robot.y, robot.yaw + turn * i / steps})) return false;
  return true;
}

/// The turn to a yaw on which the body is free, the shorter one if both are; 0 if neither is.
double LegChange::free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap) const noexcept {
  const double shorter = maps::wrap_angle(yaw - robot.yaw);
  const double longer = shorter - std::copysign(2 * std::numbers::pi, shorter);
  for (const double turn : {shorter, longer})
    if (is_free(robot, turn, costmap)) return turn;
  return 0;
}

/// Goes from a pose that faces another way than the path to a place of the path ahead.
void LegChange::turn_round(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
                           std::vector<maps::Pose>& buffer) const noexcept {
  const auto points = guide.points();
  const Manoeuvre::Limits limits{wider * options_.base.min_turning_radius, options_.base.max_reverse > 0};
  const std::size_t last = std::min(guide.leg().last, guide.nearest() + guide.points_for(longest_change));
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  Manoeuvre found;
  for (std::size_t i = guide.nearest(); i <= last; i += join_stride) {
    const double saved = guide.step() * (i - guide.nearest());
    const Manoeuvre made = find_manoeuvre(robot, points[i], limits, least + saved, costmap, footprint_);
    if (!(made.cost() < least + saved)) continue;
    least = made.cost() - saved;
    best = i;
    found = made;
  }
  if (!std::isfinite(least)) return;
  buffer.clear();
  found.append(robot, buffer);
  if (buffer.size() + points.size() > buffer.capacity()) return;
  buffer.insert(buffer.end(), points.begin() + best, points.end());
  buffer.back() = guide.goal();
  guide.set(buffer, false);
}

/// Replaces the end of the path by a manoeuvre into the goal's heading.
void LegChange::face_goal(PathGuide& guide, const Costmap& costmap,
                          std::vector<maps::Pose>& buffer) const noexcept {
  const auto points = guide.points();
  const Manoeuvre::Limits limits{wider * options_.base.min_turning_radius, options_.base.max_reverse > 0};
  const std::size_t most = guide.points_for(longest_change), last = points.size() - 1;
  const std::size_t first =
      std::max({guide.legs().back().first, guide.nearest(), last > most ? last - most : 0});
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  Manoeuvre found;
  for (std::size_t i = first; i < last; i += join_stride) {
    const double saved = guide.step() * (last - i);
    const Manoeuvre made =
        find_manoeuvre(points[i], guide.goal(), limits, least + saved, costmap, footprint_);
    if (!(made.cost() < least + saved)) continue;
    least = made.cost() - saved;
    best = i;
    found = made;
  }
  if (!std::isfinite(least)) return;
  buffer.assign(points.begin(), points.begin() + best);
  found.append(points[best], buffer);
  if (buffer.size() == buffer.capacity()) return;
  buffer.push_back(guide.goal());
  guide.set(buffer, false);
}

void LegChange::place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
                      std::vector<maps::Pose>& buffer) const noexcept {
  if (guide.step() == 0 && distance(position(robot), position(guide.goal())) > 0.5 * options_.goal_distance) {
    set_straight(buffer, robot, guide.goal(), options_.base);  // a path of one pose
    guide.set(buffer, turns_on_the_spot(options_.base));
  }
  guide.place(position(robot));
  const std::size_t ahead = std::min(guide.nearest() + guide.points_for(direction_ahead),
                                     std::max(guide.leg().last, std::size_t{1}) - 1);
  const double yaw = guide.points()[std::max(ahead, guide.leg().first)].yaw;
  const bool faces_away = !guide.leg().turns && std::abs(maps::wrap_angle(yaw - robot.yaw)) > wrong_way;
  if (options_.base.kind == BaseKind::ackermann) {
    if (faces_away) turn_round(guide, robot, costmap, buffer);
    const double end = guide.legs().back().yaw;
    if (std::abs(maps::wrap_angle(guide.goal().yaw - end)) > 0.5 * options_.goal_angle)
      face_goal(guide, costmap, buffer);
    guide.place(position(robot));
  } else if (faces_away && options_.base.kind == BaseKind::differential && turns_on_the_spot(options_.base) &&
             free_turn(robot, yaw, costmap) != 0) {
    guide.turn_first(yaw);
  }
}

void LegChange::begin_leg(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept {
  begun_ = true;
  standing_ = turn_left_ = 0;
  last_yaw_ = robot.yaw;
  if (!guide.leg().turns) return;
  turn_left_ = free_turn(robot, guide.leg().yaw, costmap);
  if (turn_left_ == 0) turn_left_ = maps::wrap_angle(guide.leg().yaw - robot.yaw);
}

bool LegChange::is_finished(const PathGuide& guide, const maps::Pose& robot) const noexcept {
  const maps::PathLeg& leg = guide.leg();
  if (leg.turns) return std::abs(turn_left_) < turn_done;
  const maps::Pose& end = guide.points()[leg.last];
  const double tolerance = 0.75 * options_.goal_distance, away = distance(position(robot), position(end));
  if (away <= tolerance) return true;
  const double yaw = guide.points()[leg.last - 1].yaw, way = leg.backward ? -1 : 1;
  const double along = way * ((end.x - robot.x) * std::cos(yaw) + (end.y - robot.y) * std::sin(yaw));
  return away <= options_.goal_distance
             ? along <= 0.5 * tolerance || standing_ > settled
             : away <= 5 * tolerance && standing_ > 2 * settled && !guide.on_last_leg();
}

void LegChange::skip(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept {
  guide.next_leg();
  begin_leg(guide, robot, costmap);
}

void LegChange::update(PathGuide& guide, const maps::Pose& robot, const Velocity& velocity,
                       const Costmap& costmap, double elapsed, std::vector<maps::Pose>& buffer) noexcept {
  if (fresh_) {
    place(guide, robot, costmap, buffer);
    begin_leg(guide, robot, costmap);
    fresh_ = false;
  }
  guide.advance(position(robot));
  const double change = maps::wrap_angle(robot.yaw - last_yaw_);
  last_yaw_ = robot.yaw;
  if (guide.leg().turns) turn_left_ -= change;
  standing_ = stands(velocity) ? standing_ + elapsed : 0;
  while (!guide.on_last_leg() && is_finished(guide, robot)) skip(guide, robot, costmap);
}

}  // namespace slalom::navigation::detail
