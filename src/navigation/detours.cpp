#include "navigation/way.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr double search_period = 0.1;   // s between searches while there is no way
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

/// Searches for the cheapest way to a point of the path behind the first closed one, and joins it to the rest
/// of the path. To points off the costmap it goes straight on from the edge. Returns false and keeps the path
/// if there is none that costs less than `most` (m), or while a search over a large costmap goes on.
bool Way::find_way(const maps::Pose& pose, const Costmap& costmap, std::size_t closed, double most) noexcept {
  const std::span<const maps::Pose> path = guide_.points();
  // Where nothing is left out of the path, and the least of it is left.
  const maps::Point behind =
      position(path[std::min(closed + guide_.points_for(0.5 * options_.look_ahead), path.size() - 1)]);
  if (!planner_.is_searching() && !planner_.begin(costmap, position(pose), chosen_, closed_.all(), &behind))
    return false;
  planner_.advance(costmap, cells_of_update);
  double least = most, not_yet = infinity;  // m of cost, the least that was found, and that may be found yet
  std::size_t best = path.size();
  maps::Point end;
  const double rejoin = footprint_.circumscribed_radius();  // m of path with room, where a detour ends
  const std::size_t unseen_stride = guide_.points_for(rejoin), most_unseen = 6 * unseen_stride;
  std::size_t unseen = 0;
  for (std::size_t i = closed + 1; i < path.size(); ++i) {
    // The path is followed in order: what is left out, beside the place that is closed, counts twice.
    const double left = guide_.step() * (path.size() - 1 - i),
                 left_out = std::max(guide_.step() * (i - closed) - 0.5 * options_.look_ahead, 0.0),
                 rest = left + 2 * left_out;
    if (rest >= least) continue;
    const maps::Point here = position(path[i]);
    const bool is_seen = planner_.knows(costmap, here);
    const double known = is_seen ? planner_.known(here) : 0;
    if (planner_.is_searching() && !(is_seen && planner_.cost_to(here) <= known)) {
      not_yet = std::min(not_yet, known + rest);
      continue;
    }
    if (first_closed(costmap, i, rejoin) < path.size()) continue;
    if (!is_seen && (++unseen > most_unseen || unseen % unseen_stride != 1)) continue;
    const auto way = is_seen ? PathPlanner::Way{here, planner_.cost_to(here)}
                             : planner_.way_off(costmap, here, least - rest);
    if (way.cost + rest >= least) continue;
    least = way.cost + rest;
    best = i;
    end = way.end;
  }
  if (planner_.is_searching() && not_yet < least) return false;
  planner_.cancel();
  if (best == path.size()) return false;
  const std::span<const maps::Point> way = planner_.path_to(end);
  if (way.empty()) return false;
  poses_.clear();
  for (const maps::Point& point : way) poses_.push_back({point.x, point.y, 0});
  const std::size_t joint = poses_.size();
  poses_.insert(poses_.end(), path.begin() + best, path.end());
  double length = 0;
  for (std::size_t i = 0; i < joint && i + 1 < poses_.size(); ++i) {
    poses_[i].yaw = std::atan2(poses_[i + 1].y - poses_[i].y, poses_[i + 1].x - poses_[i].x);
    length += distance(position(poses_[i]), position(poses_[i + 1]));
  }
  poses_.back() = guide_.goal();
  detour_left_ = guide_.step() * (path.size() - 1 - best);
  follow(poses_, length + PathPlanner::joint);
  chosen_.assign(guide_.points().begin(), guide_.points().end());
  return true;
}

/// Takes a way past somebody on the path, as around an obstacle at the place where they meet. If there is
/// none, the plans alone avoid them.
void Way::avoid_meeting(const maps::Pose& pose, const Costmap& costmap, const Others& others,
                        double elapsed) noexcept {
  since_meeting_ += elapsed;
  if (!planner_.is_searching() && since_meeting_ < search_period) return;
  const auto place = others.meeting(guide_.points().subspan(guide_.nearest()), guide_.step());
  if (!place) return planner_.cancel();
  since_meeting_ = 0;
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
    avoid_meeting(pose, costmap, others, elapsed);
    return true;
  }
  since_search_ += elapsed;
  bool found = false;
  if (planner_.is_searching() || without_way_ == 0 || since_search_ >= search_period) {
    if (!planner_.is_searching()) since_search_ = 0;
    found = find_way(pose, costmap, closed, infinity);
    if (!planner_.is_searching()) since_search_ = -since_search_;  // rests for as long as the search took
  }
  if (found || waits_at_goal(costmap, closed)) {
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
