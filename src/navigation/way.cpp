#include "navigation/way.hpp"

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr double longest_path = 2.1e5;  // steps of a path, which an update takes anew where it is blocked
constexpr double search_period = 0.1;   // s between searches while there is no way
constexpr int cells_of_update = 16000;  // cells that an update searches; the next goes on
constexpr double least_period = 1e-3;   // s
constexpr double progress_turn = 0.3;   // m of progress that a turn by 1 rad counts as
constexpr double around_joint =
    4 * PathPlanner::spacing;           // m behind the end of a detour, where the path may have a corner
constexpr double min_rejoin = 0.5;      // m of path with room that a detour needs where it ends
constexpr double longest_way_past = 5;  // m, of cost, that a way past somebody who moves may be longer

/// A robot without progress tries another way, five times. Then it stands for a while.
maps::RecoveryLengths recovery_lengths(const NavigatorOptions& options, const Footprint& footprint) {
  return {.progress = options.goal_distance,
          .relief = footprint.circumscribed_radius(),
          .jump = std::numeric_limits<double>::infinity(),
          .standing = 0.02,
          .stand_still = 0.5 * options.stuck_after,
          .patience = options.stuck_after,
          .wait = 10,
          .attempts = 5};
}

/// Whether a path is the end of another one, within `close` (m).
bool ends_alike(const maps::PathCurve& path, const maps::PathCurve& longer, double close) {
  const auto points = path.points(), others = longer.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto k = saturate_cast<std::size_t>(std::round(i * path.step() / std::max(longer.step(), 1e-3)));
    const maps::Pose &here = points[points.size() - 1 - i],
                     &there = others[others.size() - 1 - std::min(k, others.size() - 1)];
    if (distance(position(here), position(there)) > close || std::cos(here.yaw - there.yaw) < 0) return false;
  }
  return true;
}

}  // namespace

Way::Way(const NavigatorOptions& options, const Footprint& footprint, const maps::GridGeometry& geometry,
         double reach)
    : options_(options),
      footprint_(footprint),
      inner_(footprint.without_rim(geometry.resolution)),
      guide_(reach),
      planner_(geometry, footprint.half_width()),
      approach_(options, footprint),
      legs_({.near = std::min(0.75 * options.goal_distance, footprint.circumscribed_radius() / 4),
             .beside = std::min(options.goal_distance, footprint.circumscribed_radius() / 3),
             .standing = 0.02,
             .standing_turn = 0.05,
             .stops = false}),
      recovery_(recovery_lengths(options, footprint)) {
  const BaseOptions& base = options.base;  // the way to brake, too
  options_.look_ahead += base.max_forward * base.max_forward / (2 * axis_limits(base)[0].deceleration);
}

void Way::advance(const maps::Pose& robot, const Velocity& velocity, const Costmap& costmap,
                  double elapsed) noexcept {
  const auto turn = [&] {
    if (!guide_.leg().turns) return 0.0;
    const double free = approach_.free_turn(robot, guide_.leg().yaw, costmap, velocity.turn);
    return free != 0 ? free : maps::wrap_angle(guide_.leg().yaw - robot.yaw);
  };
  if (!waiting_.empty() && !(waits_ && approach_.manoeuvres(remaining()))) {
    set_yaws(waiting_, options_.base);
    follow(waiting_);
    waiting_.clear();
    detour_left_ = infinity;
  }
  if (std::exchange(is_new_, false)) {
    approach_.place(guide_, robot, costmap, poses_);
    legs_.begin(robot, turn());
  }
  const double speed = std::hypot(velocity.forward, velocity.left);
  position_ = position(robot);
  speed_ = speed + progress_turn * std::abs(velocity.turn);
  legs_.update(guide_, robot, {speed, velocity.turn}, elapsed, turn);
  make_room_for_turn(costmap);
}

/// Where there is no room for the next turn on the spot, the robot drives past the corner without it, and
/// into the goal's heading by a manoeuvre, as an Ackermann base always does.
void Way::make_room_for_turn(const Costmap& costmap) noexcept {
  if (options_.base.kind == BaseKind::ackermann) {
    if (checked_ == no_stop && remaining() < approach_.longest_change() + guide_.reach() &&
        !approach_.manoeuvres(remaining())) {
      checked_ = guide_.nearest();
      const double error = maps::wrap_angle(guide_.goal().yaw - guide_.legs().back().yaw);
      if (std::abs(error) > 0.5 * options_.goal_angle) approach_.face_goal(guide_, costmap, poses_);
    }
    return;
  }
  const auto next = guide_.legs().subspan(&guide_.leg() - guide_.legs().data()).subspan(1);
  if (next.empty() || !next[0].turns || next[0].first == checked_ ||
      guide_.step() * (next[0].first - guide_.nearest()) > approach_.longest_change())
    return;
  checked_ = next[0].first;
  const maps::Pose& corner = guide_.points()[checked_];
  if (approach_.free_turn({corner.x, corner.y, guide_.leg().yaw}, next[0].yaw, costmap) != 0) return;
  if (!guide_.join_legs()) approach_.face_goal(guide_, costmap, poses_);
}

void Way::set_path(std::span<const maps::Pose> path) {
  if (path.empty()) throw std::invalid_argument("path: no poses, must have at least one");
  double length = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!maps::is_plausible(path[i])) maps::check_pose("path: pose " + std::to_string(i), path[i]);
    if (i > 0) length += distance(position(path[i]), position(path[i - 1]));
  }
  // A detour is at most as long as a path of the search, and goes on along the path.
  const double longest = length + 2 * PathPlanner::max_points * PathPlanner::spacing;
  const std::size_t most = count(longest, PathGuide::spacing, longest_path, "path") + path.size() + 8;
  maps::PathCurve given;
  given.reserve(most);
  given.set(path, false);
  if (is_followed(given)) return;
  waits_ = !guide_.empty() && !is_stuck() && !is_done_ && approach_.manoeuvres(remaining()) &&
           is_goal(given.goal());
  given_ = std::move(given);
  const bool goes_on =
      !guide_.empty() && distance(position(guide_.goal()), position(path.back())) <= min_rejoin;
  if (!goes_on) {
    planner_.cancel();
    chosen_.clear();
    closed_.forget_dead_ends();
    without_way_ = since_search_ = 0;
  }
  if (!goes_on || is_stuck() || is_done_) recovery_.reset();
  guide_.reserve(most);
  for (auto* const poses : {&poses_, &chosen_, &waiting_}) poses->reserve(most);
  waiting_.assign(path.begin(), path.end());
  is_done_ = false;
}

/// Whether a pose is the end of the path that was given.
bool Way::is_goal(const maps::Pose& pose) const noexcept {
  return distance(position(pose), position(given_.goal())) <= 0.1 * options_.goal_distance &&
         std::abs(maps::wrap_angle(pose.yaw - given_.goal().yaw)) <= 0.2 * options_.goal_angle;
}

/// Whether a path changes nothing: it ends like the one that was given, or the robot is at its end, where no
/// way is left to decide about.
bool Way::is_followed(const maps::PathCurve& path) const noexcept {
  if (guide_.empty() || is_stuck() || (is_done_ && speed_ < recovery_.lengths().standing) ||
      !is_goal(path.goal()))
    return false;
  const double near = 2 * options_.goal_distance;
  return (guide_.remaining() <= near && distance(position_, position(guide_.goal())) <= near) ||
         ends_alike(path, given_, std::max(0.5 * options_.goal_distance, PathGuide::spacing));
}

void Way::clear() noexcept {
  guide_.clear();
  given_.clear();
  waiting_.clear();
  chosen_.clear();
  closed_.forget_dead_ends();
  planner_.cancel();
  detour_left_ = infinity;
  without_way_ = since_search_ = since_meeting_ = standing_ = 0;
  recovery_.reset();
  stop_ = no_stop;
}

/// Follows a path whose yaws are those of the robot. It need not stop at corners in the first `smooth` m.
void Way::follow(std::span<const maps::Pose> path, double smooth) noexcept {
  guide_.set(path, turns_on_the_spot(options_.base), smooth);
  approach_.forget();
  is_new_ = true;
  checked_ = stop_ = no_stop;
}

bool Way::ends_at(const maps::Pose& pose) const noexcept {
  const maps::Pose& goal = guide_.goal();
  return guide_.on_last_leg() && guide_.remaining() <= 2 * options_.goal_distance &&
         distance(position(pose), position(goal)) <= options_.goal_distance &&
         (options_.base.max_turn == 0 ||
          std::abs(maps::wrap_angle(pose.yaw - goal.yaw)) <= options_.goal_angle);
}

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
  const std::size_t unseen_stride = guide_.points_for(min_rejoin), most_unseen = 6 * unseen_stride;
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
    if (first_closed(costmap, i, min_rejoin) < path.size()) continue;
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
  follow(poses_, length + around_joint);
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
  if (closed < guide_.points().size()) find_way(pose, costmap, closed, guide_.remaining() + longest_way_past);
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
  if (!planner_.is_searching() || without_way_ > 0) without_way_ += std::max(elapsed, least_period);
  return without_way_ < options_.patience;
}

/// Whether the goal is closed; then the robot drives up to it.
bool Way::waits_at_goal(const Costmap& costmap, std::size_t closed) noexcept {
  const std::size_t last = guide_.points().size() - 1;
  if (!is_closed(costmap, last) || closed_.contain(position(guide_.points()[last]))) return false;
  const std::size_t room =
      guide_.points_for(footprint_.circumscribed_radius() - footprint_.half_width() + options_.goal_room);
  stop_ = closed > room ? closed - room : 0;
  return true;
}

void Way::watch_progress(const maps::Pose& robot, const Costmap& costmap, const Others& others,
                         double elapsed) noexcept {
  const double left = guide_.remaining() + progress_turn * std::abs(legs_.turn_left());
  const std::size_t count = guide_.points().size();
  if (std::exchange(count_, count) != count) other_ += left - left_;  // another path: the progress goes on
  left_ = left;
  const bool moves = distance(position(robot), position(stood_at_)) > 0.5 * options_.goal_distance ||
                     std::abs(maps::wrap_angle(robot.yaw - stood_at_.yaw)) > 0.5 * options_.goal_angle;
  standing_ = moves ? 0 : standing_ + elapsed;
  if (moves) stood_at_ = robot;
  recovery_.update({.arc = other_ - left,
                    .speed = speed_,
                    .waits = without_way_ > 0 || stop_ != no_stop || others.are_near(position(robot))},
                   elapsed);
  if (recovery_.begins() && recovery_.retries() && !is_stuck()) try_another_way(robot, costmap);
}

/// Where the robot makes no progress, it searches a manoeuvre onto the path ahead; the next time, it takes
/// the place ahead for a dead end. Where there is no way, those that were dead ends may be open.
void Way::try_another_way(const maps::Pose& robot, const Costmap& costmap) noexcept {
  const double size = footprint_.circumscribed_radius();
  if (without_way_ > 0) {
    closed_.forget_dead_ends();
    without_way_ = 0;
  } else if (guide_.remaining() < 2 * size) {
    is_new_ = true;
    if (approach_.dock(guide_, robot, costmap, poses_)) return;
    poses_.assign({robot, guide_.goal()});
    set_yaws(poses_, options_.base);
    follow(poses_);
  } else if ((manoeuvres_ = !manoeuvres_) && approach_.join(guide_, robot, costmap, poses_)) {
    is_new_ = true;
  } else {
    const std::size_t ahead = guide_.nearest() + guide_.points_for(1.5 * size);
    if (ahead < guide_.points().size()) closed_.add_dead_end({position(guide_.points()[ahead]), size});
  }
}

}  // namespace slalom::navigation::detail
