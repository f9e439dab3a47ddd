#include "navigation/way.hpp"

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr double longest_path = 2.1e5;  // steps of a path, which an update takes anew where it is blocked

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

/// The pose to which the robot drives first: one on the way whose yaw is asked for, or else the goal.
std::size_t next_stop(std::span<const maps::Pose> path, const NavigatorOptions& options) {
  for (std::size_t i = 1, last; options.base.max_turn > 0 && i < path.size(); i = last + 1) {
    last = i;
    while (last + 1 < path.size() && distance(position(path[i]), position(path[last + 1])) <= least_way)
      ++last;
    if (std::abs(maps::wrap_angle(path[last].yaw - path[i].yaw)) > options.goal_angle) return last;
  }
  return path.size() - 1;
}

/// The yaws (rad) that are asked for on the way.
std::vector<double> stops_of(std::span<const maps::Pose> path, const NavigatorOptions& options) {
  std::vector<double> stops;
  for (std::size_t at = 0; !path.empty() && (at = next_stop(path, options)) + 1 < path.size();
       path = path.subspan(at))
    stops.push_back(path[at].yaw);
  return stops;
}

}  // namespace

Way::Way(const NavigatorOptions& options, const Footprint& footprint, const maps::GridGeometry& geometry,
         double reach)
    : options_(options),
      footprint_(footprint),
      inner_(footprint.without_rim(geometry.resolution)),
      guide_(reach, footprint.circumscribed_radius()),
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
  if (waiting_.empty() && !later_.empty() && stops_at(robot)) waiting_.swap(later_);
  if (!waiting_.empty() && !(waits_ && approach_.manoeuvres(guide_.remaining()))) take_up();
  if (std::exchange(is_new_, false)) {
    approach_.place(guide_, robot, costmap);
    legs_.begin(robot, turn());
  }
  const double speed = std::hypot(velocity.forward, velocity.left);
  position_ = position(robot);
  speed_ = speed + footprint_.circumscribed_radius() * std::abs(velocity.turn);
  legs_.update(guide_, robot, {speed, velocity.turn}, elapsed, turn);
  make_room_for_turn(costmap);
}

/// Follows the new path up to its next stop.
void Way::take_up() noexcept {
  const auto stop = waiting_.begin() + static_cast<std::ptrdiff_t>(next_stop(waiting_, options_));
  later_.assign(stop, waiting_.end());
  waiting_.erase(stop + 1, waiting_.end());
  later_length_ = 0;
  for (std::size_t i = 1; i < later_.size(); ++i)
    later_length_ += distance(position(later_[i]), position(later_[i - 1]));
  if (later_.size() == 1) later_.clear();
  set_yaws(waiting_, options_.base);
  follow(waiting_);
  waiting_.clear();
  detour_left_ = infinity;
}

/// Where there is no room for the next turn on the spot, the robot drives past the corner without it, and
/// into the goal's heading by a manoeuvre, as an Ackermann base always does.
void Way::make_room_for_turn(const Costmap& costmap) noexcept {
  if (options_.base.kind == BaseKind::ackermann) {
    const double left = guide_.remaining();
    if (checked_ == no_stop && left < approach_.longest_change() + guide_.reach() &&
        !approach_.manoeuvres(left)) {
      checked_ = guide_.nearest();
      const double error = maps::wrap_angle(guide_.goal().yaw - guide_.legs().back().yaw);
      if (std::abs(error) > 0.5 * options_.goal_angle) approach_.face_goal(guide_, costmap);
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
  if (!guide_.join_legs()) approach_.face_goal(guide_, costmap);
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
  std::vector<double> stops = stops_of(path, options_);
  if (is_followed(given, stops)) return;
  waits_ = !guide_.empty() && !is_stuck() && !is_done_ && approach_.manoeuvres(guide_.remaining()) &&
           is_goal(given.goal());
  const bool goes_on = !guide_.empty() && distance(position(given_.goal()), position(path.back())) <=
                                              footprint_.circumscribed_radius();
  given_ = std::move(given);
  given_stops_ = std::move(stops);
  if (!goes_on) forget_tries();
  if (!goes_on || is_stuck() || is_done_) recovery_.reset();
  guide_.reserve(most);
  approach_.reserve(most);
  for (auto* const poses : {&poses_, &chosen_, &waiting_, &later_}) poses->reserve(most);
  waiting_.assign(path.begin(), path.end());
  is_done_ = false;
}

/// Whether a pose is the end of the path that was given.
bool Way::is_goal(const maps::Pose& pose) const noexcept {
  return distance(position(pose), position(given_.goal())) <= 0.1 * options_.goal_distance &&
         std::abs(maps::wrap_angle(pose.yaw - given_.goal().yaw)) <= 0.2 * options_.goal_angle;
}

/// Whether a path changes nothing: it ends like the one that was given, or the robot is at its end.
bool Way::is_followed(const maps::PathCurve& path, std::span<const double> stops) const {
  const std::size_t to_come = later_.empty() ? 0 : 1 + stops_of(later_, options_).size();
  if (stops.size() < to_come || stops.size() > given_stops_.size() ||
      !std::equal(stops.rbegin(), stops.rend(), given_stops_.rbegin()))
    return false;
  if (guide_.empty() || is_stuck() || (is_done_ && speed_ < recovery_.lengths().standing) ||
      !is_goal(path.goal()))
    return false;
  const double near = 2 * options_.goal_distance;
  return (remaining() <= near && distance(position_, position(guide_.goal())) <= near) ||
         ends_alike(path, given_, std::max(0.5 * options_.goal_distance, PathGuide::spacing));
}

void Way::clear() noexcept {
  guide_.clear();
  given_.clear();
  waiting_.clear();
  later_.clear();
  later_length_ = 0;
  detour_left_ = infinity;
  standing_ = 0;
  recovery_.reset();
  stop_ = no_stop;
  forget_tries();
}

void Way::forget_tries() noexcept {
  planner_.cancel();
  chosen_.clear();
  closed_.forget_dead_ends();
  without_way_ = searched_ = 0;
}

/// Follows a path whose yaws are those of the robot. It need not stop at corners in the first `smooth` m.
void Way::follow(std::span<const maps::Pose> path, double smooth) noexcept {
  guide_.set(path, turns_on_the_spot(options_.base), smooth);
  approach_.forget();
  is_new_ = true;
  checked_ = stop_ = no_stop;
}

/// Whether a robot is at the end of the present part of the path, within the tolerances.
bool Way::stops_at(const maps::Pose& pose) const noexcept {
  const maps::Pose& goal = guide_.goal();
  return guide_.on_last_leg() && guide_.remaining() <= 2 * options_.goal_distance &&
         distance(position(pose), position(goal)) <= options_.goal_distance &&
         (options_.base.max_turn == 0 ||
          std::abs(maps::wrap_angle(pose.yaw - goal.yaw)) <= options_.goal_angle);
}

void Way::watch_progress(const maps::Pose& robot, const Costmap& costmap, const Others& others,
                         double elapsed) noexcept {
  const double left = guide_.remaining() + footprint_.circumscribed_radius() * std::abs(legs_.turn_left());
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
    if (approach_.dock(guide_, robot, costmap)) return;
    poses_.assign({robot, guide_.goal()});
    set_yaws(poses_, options_.base);
    follow(poses_);
  } else if ((manoeuvres_ = !manoeuvres_) && approach_.join(guide_, robot, costmap)) {
    is_new_ = true;
  } else {
    const std::size_t ahead = guide_.nearest() + guide_.points_for(1.5 * size);
    if (ahead < guide_.points().size()) closed_.add_dead_end({position(guide_.points()[ahead]), size});
  }
}

}  // namespace slalom::navigation::detail
