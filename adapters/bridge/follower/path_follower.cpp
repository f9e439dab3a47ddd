#include "bridge/follower/path_follower.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "bridge/follower/follower_plan.hpp"
#include "bridge/follower/follower_settings.hpp"
#include "slalom/navigation/costmap.hpp"

namespace slalom_bridge {
namespace {

namespace nav = slalom::navigation;
namespace maps = slalom::maps;
using Problem = FollowerAnswer::Problem;

/// As nav2_costmap_2d defines them.
constexpr unsigned char lethal = 254, unknown = 255;

constexpr double longest_period = 1;   ///< s; after a longer one the robot was not controlled in between
constexpr double usual_period = 0.05;  ///< s, of the first update
constexpr double longest_braking = 3;  ///< s, after which a cancellation waits no longer

bool stands(const Velocity& v) {
  return std::hypot(v.forward, v.left) < 0.01 && std::abs(v.turn) < 0.05;
}

std::string why_of(nav::NavigationStatus status) {
  switch (status) {
    case nav::NavigationStatus::blocked:
      return "the path is blocked and there is no way round";
    case nav::NavigationStatus::no_path:
      return "the robot is off the costmap";
    case nav::NavigationStatus::bad_input:
      return "pose or velocity of the robot is not finite or too large";
    default:
      return "";
  }
}

}  // namespace

struct PathFollower::Hidden {
  explicit Hidden(const std::string& method) : settings(method) {}

  void make_navigator(const GoalTolerance& tolerance);
  double elapsed_until(double time);
  FollowerAnswer answer(const FollowerInput& input);
  FollowerAnswer judge(const nav::NavigationResult& result, double elapsed);

  FollowerSettings settings;
  std::optional<nav::Footprint> footprint;
  std::vector<Pose> vertices;  ///< of the footprint
  maps::OccupancyGrid grid;
  std::optional<nav::Costmap> costmap;
  std::optional<nav::Navigator> navigator;  ///< none: the next update makes it
  GoalTolerance tolerance;                  ///< of that navigator
  FollowerPlan plan;
  double limit = 0;  ///< m/s or percent; 0: none
  bool limit_is_percentage = false;
  double share = 1;  ///< of the limits of the base, that the limit leaves

  std::optional<double> last_time;  ///< s, of the last update
  Velocity velocity, command;       ///< of the last update
  double standing = 0;              ///< s for which the robot has braked and stood
  bool cancelling = false;
  double cancelling_for = 0;  ///< s
  std::vector<Pose> predicted, path;

  std::uint64_t seed() const {
    const slalom::SolverOptions solver = settings.solver(1);
    const std::uint64_t* const of_method = solver.find<std::uint64_t>("seed");
    return of_method ? *of_method : 0;
  }
  void find_share() {
    const double most = settings.max_forward();
    const double before = share;
    share = limit == 0 ? 1.0 : std::min(limit_is_percentage ? limit / 100 : limit / most, 1.0);
    if (share != before) navigator.reset();
  }
};

PathFollower::PathFollower(const std::string& method) : hidden_(std::make_unique<Hidden>(method)) {}
PathFollower::~PathFollower() = default;

std::vector<Option> PathFollower::options() const {
  return hidden_->settings.list();
}

bool PathFollower::visualizes() const {
  return hidden_->settings.own().visualize;
}
double PathFollower::transform_tolerance() const {
  return hidden_->settings.own().transform_tolerance;
}

void PathFollower::change(const Changes& changes) {
  FollowerSettings changed = hidden_->settings;
  for (const auto& [name, text] : changes) changed.set(name, text);
  // What no single range refuses is refused here: a navigator over the smallest of maps.
  const nav::Costmap smallest(3, 3, 0.1);
  const nav::Navigator made(nav::Footprint::rectangle(0.1, 0.1, 0.2), changed.navigator(1), changed.solver(1),
                            smallest);
  const bool other_costmap = changed.own().unknown_cells != hidden_->settings.own().unknown_cells;
  hidden_->settings = changed;
  hidden_->navigator.reset();
  if (other_costmap) hidden_->costmap.reset();
  hidden_->find_share();
}

void PathFollower::use_footprint(const std::vector<Pose>& vertices) {
  const auto same = [](const Pose& a, const Pose& b) { return a.x == b.x && a.y == b.y; };
  if (hidden_->footprint &&
      std::equal(vertices.begin(), vertices.end(), hidden_->vertices.begin(), hidden_->vertices.end(), same))
    return;
  std::vector<maps::Point> points;
  for (const Pose& vertex : vertices) points.push_back({vertex.x, vertex.y});
  hidden_->footprint.emplace(nav::Footprint(points));
  hidden_->vertices = vertices;
  hidden_->navigator.reset();
}

void PathFollower::use_costmap(const CostGrid& from) {
  maps::OccupancyGrid& grid = hidden_->grid;
  const bool same_size = hidden_->costmap && grid.width == from.width && grid.height == from.height &&
                         grid.resolution == from.resolution;
  if (!same_size) {
    nav::Costmap made(from.width, from.height, from.resolution, hidden_->settings.own().unknown_cells);
    hidden_->navigator.reset();
    hidden_->costmap.emplace(std::move(made));
    grid.width = from.width;
    grid.height = from.height;
    grid.resolution = from.resolution;
    grid.cells.resize(static_cast<std::size_t>(from.width) * static_cast<std::size_t>(from.height));
  }
  grid.origin = {from.x, from.y, 0};
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const unsigned char cost = from.costs[i];
    grid.cells[i] = cost == unknown  ? maps::Occupancy::unknown
                    : cost == lethal ? maps::Occupancy::occupied
                                     : maps::Occupancy::free;
  }
  if (!hidden_->costmap->update(grid)) throw std::invalid_argument("costmap: its origin must be finite");
}

void PathFollower::use_plan(const std::vector<Pose>& plan, const std::string& frame) {
  hidden_->plan.use(plan, frame);
  hidden_->cancelling = false;
}

void PathFollower::limit_speed(double limit, bool percentage) {
  if (!std::isfinite(limit) || limit < 0)
    throw std::invalid_argument("speed limit: " + std::to_string(limit) + " must be finite and at least 0");
  hidden_->limit = limit;
  hidden_->limit_is_percentage = percentage;
  hidden_->find_share();
}

bool PathFollower::cancel() {
  if (!hidden_->cancelling) {
    hidden_->cancelling = true;
    hidden_->cancelling_for = 0;
    hidden_->plan.clear();
    if (hidden_->navigator) hidden_->navigator->reset(hidden_->seed());
  }
  return !hidden_->navigator || stands(hidden_->velocity) || hidden_->cancelling_for > longest_braking;
}

void PathFollower::reset() {
  hidden_->plan.clear();
  if (hidden_->navigator) hidden_->navigator->reset(hidden_->seed());
  hidden_->cancelling = false;
  hidden_->standing = 0;
  hidden_->last_time.reset();
  hidden_->velocity = hidden_->command = {};
  hidden_->predicted.clear();
  hidden_->path.clear();
}

FollowerAnswer PathFollower::update(const FollowerInput& input) {
  try {
    return hidden_->answer(input);
  } catch (const std::exception& error) {
    hidden_->command = {};
    return {Problem::no_control, error.what(), "", {}, 0};
  }
}

std::vector<Pose> PathFollower::predicted() const {
  return hidden_->predicted;
}
std::vector<Pose> PathFollower::path() const {
  return hidden_->path;
}

/// The goal checker decides when the goal is reached; the navigator must not stand before.
void PathFollower::Hidden::make_navigator(const GoalTolerance& told) {
  const auto equal = [](const GoalTolerance& a, const GoalTolerance& b) {
    return a.known == b.known && a.distance == b.distance && a.angle == b.angle;
  };
  if (navigator && equal(told, tolerance)) return;
  nav::NavigatorOptions options = settings.navigator(share);
  constexpr double least = 0.001, every_heading = 4;  // what the navigator takes
  if (told.known && told.distance > 0)
    options.goal_distance = std::clamp(told.distance, least, options.goal_distance);
  if (told.known)
    options.goal_angle = told.angle > 0 ? std::clamp(told.angle, least, options.goal_angle) : every_heading;
  navigator.emplace(*footprint, options, settings.solver(share), *costmap);
  tolerance = told;
  plan.forget_placement();
}

double PathFollower::Hidden::elapsed_until(double time) {
  const double since = last_time ? time - *last_time : usual_period;
  last_time = time;
  return since > 0 && since < longest_period ? since : usual_period;
}

FollowerAnswer PathFollower::Hidden::answer(const FollowerInput& input) {
  const double elapsed = elapsed_until(input.time);
  velocity = settings.own().open_loop ? command : input.velocity;
  if (plan.empty() && !cancelling) return {Problem::invalid_path, "no path was set", "", {}, 0};
  if (!costmap) return {Problem::no_control, "there is no costmap", "", {}, 0};
  if (!footprint) return {Problem::no_control, "the robot has no footprint", "", {}, 0};
  make_navigator(input.tolerance);
  if (!plan.empty()) {
    if (const std::vector<maps::Pose>* const placed = plan.place(input.plan_frame, input.pose))
      navigator->set_path(*placed);
  }
  const nav::NavigationResult result =
      navigator->update({input.pose.x, input.pose.y, input.pose.yaw},
                        {velocity.forward, velocity.left, velocity.turn}, *costmap, elapsed);
  const auto copy = [](std::vector<Pose>& to, std::span<const maps::Pose> from) {
    to.clear();
    for (const maps::Pose& each : from) to.push_back({each.x, each.y, each.yaw});
  };
  copy(predicted, result.plan);
  copy(path, result.path);
  const FollowerAnswer judged = judge(result, elapsed);
  command = judged.command;
  return judged;
}

FollowerAnswer PathFollower::Hidden::judge(const nav::NavigationResult& result, double elapsed) {
  FollowerAnswer answer;
  answer.status = nav::name(result.status);
  answer.remaining = result.remaining;
  answer.command = {result.command.forward, result.command.left, result.command.turn};
  if (cancelling) {  // without a path the navigator brakes
    cancelling_for += elapsed;
    return answer;
  }
  standing =
      result.status == nav::NavigationStatus::braking && stands(answer.command) ? standing + elapsed : 0;
  answer.why = standing > settings.navigator(1).patience ? "every plan collides" : why_of(result.status);
  if (answer.why.empty()) return answer;
  answer.problem = Problem::no_control;
  answer.command = {};
  return answer;
}

}  // namespace slalom_bridge
