#include "navigation/way.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr int cells_of_update = 16000;  // cells that an update searches; the next goes on

}  // namespace

/// The first closed point of a part of the path (m); the number of points if there is none.
std::size_t Way::first_closed(const Costmap& costmap, std::size_t first, double length) const noexcept {
  const std::size_t count = guide_.points().size();
  const std::size_t end = std::min(count, first + guide_.points_for(length) + 1);
  for (std::size_t i = first; i < end; ++i)
    if (is_closed(costmap, i)) return i;
  return count;
}

/// Whether a point is closed: the body has no room there, in a manoeuvre at just this yaw but for a rim that
/// the search did not see, or it is in a closed place.
bool Way::is_closed(const Costmap& costmap, std::size_t point) const noexcept {
  const maps::Pose& pose = guide_.points()[point];
  const maps::Point place = position(pose);
  if (closed_.contain(place)) return true;
  const double left = guide_.step() * static_cast<double>(guide_.points().size() - 1 - point);
  return planner_.knows(costmap, place) &&
         (approach_.manoeuvres(left) ? costmap.collides(inner_, pose) : !planner_.has_room(costmap, place));
}

/// Searches for the cheapest way to a point of the path behind the first closed one, and takes it. Returns
/// false and keeps the path if there is none that costs less than `most` (m), or while the search goes on.
bool Way::find_way(const maps::Pose& pose, const Costmap& costmap, std::size_t closed, double most) noexcept {
  if (!planner_.is_searching() && searched_ > 0) {  // rests for as long as the last search took
    --searched_;
    return false;
  }
  const std::span<const maps::Pose> path = guide_.points();
  // Where nothing is left out of the path, and the least of it is left.
  const std::size_t usual = closed + guide_.points_for(0.5 * options_.look_ahead);
  const maps::Point behind = position(path[std::min(usual, path.size() - 1)]);
  if (!planner_.is_searching() && !planner_.begin(costmap, position(pose), chosen_, closed_.all(), &behind))
    return false;
  planner_.advance(costmap, cells_of_update);
  ++searched_;
  const Joint joint = cheapest_joint(costmap, closed, usual, most);
  if (planner_.is_searching() && joint.not_yet) return false;
  planner_.cancel();
  return joint.point < path.size() && take_detour(joint);
}

/// The cheapest place to join the path again behind its first closed point. What is left out beyond the
/// `usual` point counts twice, since paths are followed in order. Off the costmap the way goes straight on.
Way::Joint Way::cheapest_joint(const Costmap& costmap, std::size_t closed, std::size_t usual,
                               double most) const noexcept {
  const std::size_t count = guide_.points().size();
  const double rejoin = footprint_.circumscribed_radius();  // m of path with room, where a detour ends
  const std::size_t unseen_stride = guide_.points_for(rejoin), most_unseen = 6 * unseen_stride;
  Joint best{.point = count, .cost = most};
  double not_yet = infinity;  // m, the least cost that may be found yet
  std::size_t unseen = 0;
  for (std::size_t i = closed + 1; i < count; ++i) {
    const double rest = guide_.step() * (count - 1 - i + 2 * (std::max(i, usual) - usual));
    if (rest >= best.cost) continue;
    const maps::Point here = position(guide_.points()[i]);
    const bool is_seen = planner_.knows(costmap, here);
    const double known = is_seen ? planner_.known(here) : 0;
    if (planner_.is_searching() && !(is_seen && planner_.cost_to(here) <= known)) {
      not_yet = std::min(not_yet, known + rest);
      continue;
    }
    if (first_closed(costmap, i, rejoin) < count) continue;
    if (!is_seen && (++unseen > most_unseen || unseen % unseen_stride != 1)) continue;
    const auto way = is_seen ? PathPlanner::Way{here, planner_.cost_to(here)}
                             : planner_.way_off(costmap, here, best.cost - rest);
    if (way.cost + rest < best.cost) best = {i, way.end, way.cost + rest};
  }
  best.not_yet = not_yet < best.cost;
  return best;
}

/// Follows the way that was found to a joint, and the path from there on.
bool Way::take_detour(const Joint& joint) noexcept {
  const std::span<const maps::Point> way = planner_.path_to(joint.end);
  if (way.empty()) return false;
  const std::span<const maps::Pose> rest = guide_.points().subspan(joint.point);
  poses_.clear();
  for (const maps::Point& point : way) poses_.push_back({point.x, point.y, 0});
  poses_.insert(poses_.end(), rest.begin(), rest.end());
  double length = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    poses_[i].yaw = std::atan2(poses_[i + 1].y - poses_[i].y, poses_[i + 1].x - poses_[i].x);
    length += distance(position(poses_[i]), position(poses_[i + 1]));
  }
  poses_.back() = guide_.goal();
  detour_left_ = guide_.step() * (rest.size() - 1);
  searched_ = 0;
  follow(poses_, length + PathPlanner::joint);
  chosen_.assign(guide_.points().begin(), guide_.points().end());
  return true;
}

/// Takes a way past somebody on the path, as around an obstacle where they meet, or leaves it to the plans.
void Way::avoid_meeting(const maps::Pose& pose, const Costmap& costmap, const Others& others) noexcept {
  const auto place = others.meeting(guide_.points().subspan(guide_.nearest()), guide_.step());
  if (!place) return planner_.cancel();
  closed_.begin_meeting(*place);
  const std::size_t closed = first_closed(costmap, guide_.nearest(), options_.look_ahead);
  if (closed < guide_.points().size())
    find_way(pose, costmap, closed, guide_.remaining() + options_.look_ahead);
  closed_.end_meeting();
}

bool Way::keep(const maps::Pose& pose, const Costmap& costmap, const Others& others,
               double elapsed) noexcept {
  watch_progress(pose, costmap, others, elapsed);
  stop_ = no_stop;
  if (!options_.find_detours) return true;
  const std::size_t closed = first_closed(costmap, guide_.nearest(), options_.look_ahead);
  if (closed == guide_.points().size()) {
    without_way_ = 0;
    avoid_meeting(pose, costmap, others);
    return true;
  }
  if (without_way_ == 0) searched_ = planner_.is_searching() ? searched_ : 0;
  if (find_way(pose, costmap, closed, infinity) || waits_at_goal(costmap, closed)) {
    without_way_ = 0;
    return true;
  }
  if (!planner_.is_searching() || without_way_ > 0)
    without_way_ += std::max(elapsed, std::numeric_limits<double>::min());
  return without_way_ < options_.patience;
}

/// Whether the goal is closed; then the robot drives up to it. A stop on the way that is closed is left out.
bool Way::waits_at_goal(const Costmap& costmap, std::size_t closed) noexcept {
  const std::size_t last = guide_.points().size() - 1;
  if (!is_closed(costmap, last) || closed_.contain(position(guide_.points()[last]))) return false;
  if (!later_.empty()) {
    waiting_.swap(later_);
    return true;
  }
  const std::size_t room =
      guide_.points_for(footprint_.circumscribed_radius() - footprint_.half_width() + options_.goal_room);
  stop_ = closed > room ? closed - room : 0;
  return true;
}

}  // namespace slalom::navigation::detail
