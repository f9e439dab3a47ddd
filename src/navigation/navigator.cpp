#include "slalom/navigation/navigator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "navigation/base_model.hpp"
#include "navigation/others.hpp"
#include "navigation/path_ahead.hpp"
#include "navigation/path_guide.hpp"
#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/navigation/path_planner.hpp"

namespace slalom::navigation {

namespace {

constexpr double longest_path = 1e6;   // steps of a path
constexpr double search_period = 0.1;  // s between searches while there is no way
constexpr double nearest_unseen =
    0.5;  // m before a closed place, beside those of braking, at which its end is seen
constexpr double least_period = 1e-3;   // s
constexpr double progress_step = 0.1;   // m of progress after which the robot is not stuck
constexpr double settling = 1;          // m before the goal, where a robot that turns makes no progress
constexpr double dead_end_ahead = 0.2;  // m from the robot's front to the middle of the closed place
constexpr double retry_after = 10;      // s without a way after which ways that were closed are tried again
constexpr int steps_to_react = 2;       // steps of a plan, beside those of braking, that must be free
constexpr double max_period = 0.2;      // s for which the robot brakes in one command
constexpr double longest_way_past = 5;  // m, of cost, that a way past somebody who moves may be longer

bool plausible(const Velocity& v) {
  return std::abs(v.forward) <= Velocity::largest && std::abs(v.left) <= Velocity::largest &&
         std::abs(v.turn) <= Velocity::largest;
}

maps::Point position(const maps::Pose& pose) {
  return {pose.x, pose.y};
}

/// The last step of an update: makes the command finite and moves it into the limits of the base. Counts the
/// changed values in `corrections`.
void check_result(NavigationResult& result, const BaseOptions& base) noexcept {
  const auto check = [&](double& value, double least, double most) {
    const double valid = std::clamp(std::isfinite(value) ? value : 0.0, least, most);
    result.corrections += valid != value;
    value = valid;
  };
  const double sideways = base.kind == BaseKind::omnidirectional ? base.max_sideways : 0;
  check(result.command.forward, -base.max_reverse, base.max_forward);
  check(result.command.left, -sideways, sideways);
  check(result.command.turn, -base.max_turn, base.max_turn);
}

}  // namespace

class Navigator::Implementation {
 public:
  Implementation(const Footprint& footprint, const NavigatorOptions& options, const SolverOptions& solver,
                 const Costmap& costmap)
      : options_((validate_options(options, "navigator"), options)),
        footprint_(footprint),
        geometry_(costmap.geometry()),
        model_(detail::make_base_model(options, footprint, geometry_.resolution, solver)),
        guide_(static_cast<double>(model_->plan().size()) * options.time_step *
               std::max({options.base.max_forward, options.base.max_reverse, options.base.max_sideways})),
        planner_(geometry_, footprint.half_width()),
        others_(footprint, options, model_->plan().size() - 1) {}

  void set_path(std::span<const maps::Pose> path);
  NavigationResult update(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                          double elapsed, std::span<const maps::PredictedObstacle> others) noexcept;
  void reset(std::uint64_t seed) noexcept;
  const BaseOptions& base() const noexcept { return options_.base; }
  std::unique_ptr<Implementation> clone() const { return std::make_unique<Implementation>(*this); }

 private:
  bool fits(const Costmap& costmap) const noexcept;
  bool is_at_goal(const maps::Pose& pose) const noexcept;
  detail::PathAhead ahead(const Costmap& costmap) const noexcept {
    return {guide_, planner_, closed_, costmap};
  }
  bool find_way(const maps::Pose& pose, const Costmap& costmap, std::size_t closed, double most) noexcept;
  void avoid_meeting(const maps::Pose& pose, const Costmap& costmap, double elapsed) noexcept;
  bool keep_way(const maps::Pose& pose, const Costmap& costmap, double elapsed) noexcept;
  void watch_progress(const maps::Point& robot, double elapsed) noexcept;
  bool plan_collides(const Costmap& costmap, const Velocity& velocity) const noexcept;
  NavigationResult stand(NavigationStatus status, const Velocity& velocity, double elapsed) const noexcept;

  NavigatorOptions options_;
  Footprint footprint_;
  maps::GridGeometry geometry_;
  Polymorphic<detail::BaseModel> model_;
  detail::PathGuide guide_;
  PathPlanner planner_;
  detail::Others others_;
  NavigationMaps maps_;
  ReservedVector<maps::Point> points_;  ///< points of a path that is being made
  ReservedVector<maps::Pose> chosen_;   ///< the last detour, which later searches prefer
  detail::ClosedPlaces closed_;
  double detour_left_ = std::numeric_limits<double>::infinity();  ///< m of path left where the detour ends
  double without_way_ = 0;    ///< s since the path is blocked and no way round was found
  double since_search_ = 0;   ///< s
  double since_meeting_ = 0;  ///< s
  double since_solve_ = 0;    ///< s
  double min_remaining_ = std::numeric_limits<double>::infinity();  ///< m
  double without_progress_ = 0;                                     ///< s
};

void Navigator::Implementation::set_path(std::span<const maps::Pose> path) {
  if (path.empty()) throw std::invalid_argument("path: no poses, must have at least one");
  double length = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!maps::is_plausible(path[i])) maps::check_pose("path: pose " + std::to_string(i), path[i]);
    if (i > 0) length += distance(position(path[i]), position(path[i - 1]));
  }
  if (guide_.empty() ||
      distance(position(guide_.goal()), position(path.back())) > detail::PathAhead::min_rejoin) {
    chosen_.clear();
    closed_.forget_dead_ends();
  }
  // A detour is at most as long as a path of the search, and goes on along the path.
  const double longest = length + 2 * static_cast<double>(PathPlanner::max_points) * PathPlanner::spacing;
  const std::size_t most = count(longest, detail::PathGuide::spacing, longest_path, "path") + path.size() + 8;
  guide_.reserve(most);
  points_.reserve(most);
  chosen_.reserve(most);
  points_.clear();
  for (const maps::Pose& pose : path) points_.push_back(position(pose));
  guide_.set(points_, path.back());
  detour_left_ = min_remaining_ = std::numeric_limits<double>::infinity();
  without_way_ = since_search_ = without_progress_ = 0;
}

void Navigator::Implementation::reset(std::uint64_t seed) noexcept {
  guide_.clear();
  chosen_.clear();
  closed_.forget_dead_ends();
  others_.clear();
  detour_left_ = min_remaining_ = std::numeric_limits<double>::infinity();
  without_way_ = since_search_ = since_meeting_ = since_solve_ = without_progress_ = 0;
  model_->reset(seed);
}

bool Navigator::Implementation::fits(const Costmap& costmap) const noexcept {
  const maps::GridGeometry& g = costmap.geometry();
  return g.rows == geometry_.rows && g.columns == geometry_.columns && g.resolution == geometry_.resolution;
}

bool Navigator::Implementation::is_at_goal(const maps::Pose& pose) const noexcept {
  const maps::Pose& goal = guide_.goal();
  return distance(position(pose), position(goal)) <= options_.goal_distance &&
         std::abs(maps::wrap_angle(pose.yaw - goal.yaw)) <= options_.goal_angle;
}

/// Searches for the cheapest way to a point of the path behind the first closed one, and joins it to the rest
/// of the path. Returns false and keeps the path if there is none that costs less than `most` (m).
bool Navigator::Implementation::find_way(const maps::Pose& pose, const Costmap& costmap, std::size_t closed,
                                         double most) noexcept {
  planner_.read(costmap, chosen_, closed_.all());
  if (!planner_.search_from(position(pose))) return false;
  const std::span<const maps::Pose> path = guide_.points();
  double least = most;
  std::size_t best = path.size();
  for (std::size_t i = closed + 1; i < path.size(); ++i) {
    const double left = guide_.step() * static_cast<double>(path.size() - 1 - i);
    const double cost = planner_.cost_to(position(path[i])) + left;
    if (cost >= least || !ahead(costmap).can_rejoin(i)) continue;
    least = cost;
    best = i;
  }
  if (best == path.size()) return false;
  const std::span<const maps::Point> way = planner_.path_to(position(path[best]));
  points_.assign(way.begin(), way.end());
  for (std::size_t i = best; i < path.size(); ++i) points_.push_back(position(path[i]));
  detour_left_ = guide_.step() * static_cast<double>(path.size() - 1 - best);
  const maps::Pose goal = guide_.goal();
  guide_.set(points_, goal);
  chosen_.assign(guide_.points().begin(), guide_.points().end());
  min_remaining_ = std::numeric_limits<double>::infinity();
  return true;
}

/// Takes a way past somebody on the path, as around an obstacle at the place where they meet. If there is
/// none, the plans alone avoid them.
void Navigator::Implementation::avoid_meeting(const maps::Pose& pose, const Costmap& costmap,
                                              double elapsed) noexcept {
  since_meeting_ += elapsed;
  if (since_meeting_ < search_period) return;
  const auto place = others_.meeting(guide_.points().subspan(guide_.nearest()), guide_.step());
  if (!place) return;
  since_meeting_ = 0;
  const detail::ClosedPlaces::Meeting meeting(closed_, *place);
  const std::size_t closed = ahead(costmap).first_closed(options_.look_ahead);
  if (closed < guide_.points().size()) find_way(pose, costmap, closed, guide_.remaining() + longest_way_past);
}

/// Keeps the path ahead open. Returns false if there has been no way for longer than patience.
bool Navigator::Implementation::keep_way(const maps::Pose& pose, const Costmap& costmap,
                                         double elapsed) noexcept {
  watch_progress(position(pose), elapsed);
  const std::size_t closed = ahead(costmap).first_closed(options_.look_ahead);
  if (closed == guide_.points().size()) {
    without_way_ = 0;
    avoid_meeting(pose, costmap, elapsed);
    return true;
  }
  since_search_ += elapsed;
  if (without_way_ == 0 || since_search_ >= search_period) {
    since_search_ = 0;
    if (find_way(pose, costmap, closed, std::numeric_limits<double>::infinity())) {
      without_way_ = 0;
      return true;
    }
  }
  // A costmap that moves with the robot may show the end of the closed place once the robot is nearer.
  const BaseOptions& base = options_.base;
  const double braking = base.max_forward * base.max_forward / (2 * base.max_acceleration);
  if (ahead(costmap).opens_off_the_map(closed, nearest_unseen + braking)) {
    without_way_ = least_period;
    return true;
  }
  without_way_ += std::max(elapsed, least_period);
  if (without_way_ > retry_after && closed_.has_dead_ends()) {
    closed_.forget_dead_ends();
    without_way_ = 0;
  }
  return without_way_ < options_.patience;
}

/// Notes a dead end ahead where the robot makes no progress.
void Navigator::Implementation::watch_progress(const maps::Point& robot, double elapsed) noexcept {
  const double remaining = guide_.remaining();
  const bool waits = without_way_ > 0 || remaining < settling || others_.are_near(robot);
  if (waits || remaining < min_remaining_ - progress_step) {
    min_remaining_ = std::min(min_remaining_, remaining);
    without_progress_ = 0;
    return;
  }
  without_progress_ += elapsed;
  if (without_progress_ < options_.stuck_after) return;
  without_progress_ = 0;
  const std::size_t ahead = guide_.points_for(footprint_.circumscribed_radius() + dead_end_ahead);
  const std::span<const maps::Pose> path = guide_.points();
  closed_.add_dead_end(position(path[std::min(guide_.nearest() + ahead, path.size() - 1)]));
}

/// Whether the plan meets a fixed or moving obstacle before the robot could brake. A body that
/// overlaps an obstacle already may leave it.
bool Navigator::Implementation::plan_collides(const Costmap& costmap,
                                              const Velocity& velocity) const noexcept {
  const std::span<const maps::Pose> plan = model_->plan();
  const double speed = std::hypot(velocity.forward, velocity.left);
  const double braking = speed / (options_.base.max_acceleration * options_.time_step);
  const std::size_t last = std::min(
      plan.size() - 1, saturate_cast<std::size_t>(std::min(std::ceil(braking), 1e6)) + steps_to_react);
  if (others_.meet(plan, last)) return true;
  if (costmap.collides(footprint_, plan.front())) return false;
  for (std::size_t i = 1; i <= last; ++i)
    if (costmap.collides(footprint_, plan[i - 1], plan[i])) return true;
  return false;
}

/// Brakes, or stands.
NavigationResult Navigator::Implementation::stand(NavigationStatus status, const Velocity& velocity,
                                                  double elapsed) const noexcept {
  NavigationResult result;
  result.status = status;
  result.remaining = guide_.remaining();
  result.path = guide_.points();
  if (!plausible(velocity)) return result;
  const double period = std::clamp(elapsed, 0.0, max_period);
  const double speed = std::hypot(velocity.forward, velocity.left);
  const double kept = speed > 0 ? std::max(1 - options_.base.max_acceleration * period / speed, 0.0) : 0;
  const double turn = std::abs(velocity.turn);
  const double slower = std::max(turn - options_.base.max_turn_acceleration * period, 0.0);
  result.command = {kept * velocity.forward, kept * velocity.left, std::copysign(slower, velocity.turn)};
  return result;
}

NavigationResult Navigator::Implementation::update(const maps::Pose& pose, const Velocity& velocity,
                                                   const Costmap& costmap, double elapsed,
                                                   std::span<const maps::PredictedObstacle> others) noexcept {
  if (!maps::is_plausible(pose) || !plausible(velocity) || !(elapsed >= 0) || !std::isfinite(elapsed) ||
      !fits(costmap))
    return stand(NavigationStatus::bad_input, velocity, std::isfinite(elapsed) ? elapsed : 0);
  since_solve_ += elapsed;
  if (guide_.empty() || costmap.geometry().row(pose.x) < 0 || costmap.geometry().column(pose.y) < 0)
    return stand(NavigationStatus::no_path, velocity, elapsed);
  guide_.advance(position(pose));
  others_.update(others, position(pose));
  if (is_at_goal(pose)) return stand(NavigationStatus::goal_reached, velocity, elapsed);
  if (options_.find_detours && !keep_way(pose, costmap, elapsed))
    return stand(NavigationStatus::blocked, velocity, elapsed);
  maps_.distances = costmap.distances();
  maps_.prices = costmap.prices();
  maps_.others = others_.view();
  guide_.write(position(pose), maps_);
  model_->solve(maps_, pose, velocity, since_solve_);
  since_solve_ = 0;
  NavigationResult result;
  if (plan_collides(costmap, velocity)) {
    result = stand(NavigationStatus::braking, velocity, elapsed);
  } else {
    result.command = model_->command();
    result.status =
        guide_.remaining() > detour_left_ ? NavigationStatus::detour : NavigationStatus::following;
  }
  result.remaining = guide_.remaining();
  result.plan = model_->plan();
  result.path = guide_.points();
  return result;
}

Navigator::Navigator(const Footprint& footprint, const NavigatorOptions& options, const SolverOptions& solver,
                     const Costmap& costmap)
    : implementation_(std::make_unique<Implementation>(footprint, options, solver, costmap)) {}
Navigator::Navigator(const Footprint& footprint, const NavigatorOptions& options, const Costmap& costmap)
    : Navigator(footprint, options, svg_mppi_options(options.base), costmap) {}
Navigator::~Navigator() = default;
Navigator::Navigator(const Navigator&) = default;
Navigator& Navigator::operator=(const Navigator&) = default;
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;

void Navigator::set_path(std::span<const maps::Pose> path) {
  implementation_->set_path(path);
}

NavigationResult Navigator::update(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                                   double elapsed, std::span<const maps::PredictedObstacle> others) noexcept {
  NavigationResult result = implementation_->update(pose, velocity, costmap, elapsed, others);
  check_result(result, implementation_->base());
  return result;
}

void Navigator::reset(std::uint64_t seed) noexcept {
  implementation_->reset(seed);
}

}  // namespace slalom::navigation
