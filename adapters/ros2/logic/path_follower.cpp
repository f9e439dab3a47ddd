#include "logic/path_follower.hpp"

#include "slalom/core/option_access.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/navigation/navigation_problem.hpp"
#include "slalom/solvers/trajectories.hpp"
#include "slalom/tracking/people.hpp"

namespace slalom::nodes {
namespace {

namespace nav = navigation;
using Problem = FollowerAnswer::Problem;

/// The costs of nav2_costmap_2d with a special meaning.
constexpr unsigned char lethal = 254, unknown = 255;
constexpr double dearest = 252;  // cost of a cell, of those without an obstacle

constexpr double longest_period = 1;   ///< s; after a longer one the robot was not controlled in between
constexpr double usual_period = 0.05;  ///< s, of the first update
constexpr double longest_braking = 3;  ///< s, after which a cancellation waits no longer
constexpr double notable = 0.02;       ///< m by which a point of the plan moves
constexpr double around = 0.15;        ///< m around people where cells of the costmap are theirs
constexpr double lag = 0.4;            ///< s by which these cells may be late
constexpr double behind = 0.5;         ///< m of the plan behind the robot that the navigator takes

bool stands(const nav::Velocity& v) {
  return std::hypot(v.forward, v.left) < 0.01 && std::abs(v.turn) < 0.05;
}

/// The reason why a navigator does not drive, for the user; empty if it does.
std::string why_of(nav::NavigationStatus status) {
  using enum nav::NavigationStatus;
  constexpr std::pair<nav::NavigationStatus, const char*> reasons[] = {
      {blocked, "the path is blocked and there is no way round"},
      {goal_occupied, "the goal is occupied"},
      {stuck, "the robot makes no progress"},
      {commands_ignored, "the velocity of the robot does not follow the commands"},
      {no_path, "the robot is off the costmap"},
      {bad_input, "pose or velocity of the robot is not finite or too large"}};
  for (const auto& [reason, words] : reasons)
    if (reason == status) return words;
  return "";
}

}  // namespace

PathFollower::PathFollower(const std::string& method)
    : settings_(method),
      people_(tracking::ObjectTracker(tracking::people_tracker_options()),
              tracking::Predictor(tracking::people_predictor_options())) {}

void PathFollower::change(const Changes& changes) {
  FollowerSettings changed = settings_;
  for (const auto& [name, text] : changes) changed.set(name, text);
  // A navigator over the smallest of maps refuses combinations that no single range refuses.
  const nav::Costmap smallest(3, 3, 0.1);
  const nav::Navigator made(nav::Footprint::rectangle(0.1, 0.1, 0.2), changed.navigator(1), changed.solver(1),
                            smallest);
  const bool other_costmap = changed.own().unknown_cells != settings_.own().unknown_cells;
  settings_ = changed;
  navigator_.reset();
  if (other_costmap) costmap_.reset();
  find_share();
}

void PathFollower::add_cost(const std::string& name, nav::StateCost cost) {
  own_costs_.emplace_back(name, std::move(cost));
  navigator_.reset();
}

void PathFollower::use_footprint(const std::vector<maps::Point>& vertices) {
  const auto same = [](const maps::Point& a, const maps::Point& b) { return a.x == b.x && a.y == b.y; };
  if (footprint_ && std::equal(vertices.begin(), vertices.end(), vertices_.begin(), vertices_.end(), same))
    return;
  footprint_.emplace(nav::Footprint(vertices));
  vertices_ = vertices;
  navigator_.reset();
}

void PathFollower::use_costmap(const CostGrid& from) {
  maps::OccupancyGrid& grid = grid_;
  const bool same_size = costmap_ && grid.width == from.width && grid.height == from.height &&
                         grid.resolution == from.resolution;
  if (!same_size) {
    nav::Costmap made(from.width, from.height, from.resolution, settings_.own().unknown_cells);
    navigator_.reset();
    costmap_.emplace(std::move(made));
    grid.width = from.width;
    grid.height = from.height;
    grid.resolution = from.resolution;
    grid.cells.resize(static_cast<std::size_t>(from.width) * static_cast<std::size_t>(from.height));
    prices_.resize(grid.cells.size());
  }
  grid.origin = {from.x, from.y, 0};
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const unsigned char cost = from.costs[i];
    grid.cells[i] = cost == unknown  ? maps::Occupancy::unknown
                    : cost == lethal ? maps::Occupancy::occupied
                                     : maps::Occupancy::free;
    const double share = cost < lethal ? std::min(cost / dearest, 1.0) : 0;
    prices_[i] = static_cast<float>(settings_.own().cell_price * share * share);
  }
  if (!costmap_->update(grid, prices_)) throw std::invalid_argument("costmap: its origin must be finite");
}

void PathFollower::use_plan(const std::vector<maps::Pose>& plan) {
  if (plan.empty()) throw std::invalid_argument("path: no poses, must have at least one");
  for (std::size_t i = 0; i < plan.size(); ++i)
    if (!maps::is_plausible(plan[i])) maps::check_pose("path: pose " + std::to_string(i), plan[i]);
  plan_ = plan;
  placed_frame_.reset();
  remaining_ = std::numeric_limits<double>::infinity();
  cancelling_ = false;
}

/// Takes people who are predicted off the costmap, which shows them where they were when it was made.
void PathFollower::clear(std::span<const maps::PredictedObstacle> others) {
  if (others.empty()) return;
  const auto is_near = [&](const maps::Point& cell, const maps::PredictedObstacle& each) {
    const maps::Pose now = each.at(each.likeliest(), 0).pose, next = each.at(each.likeliest(), lag).pose;
    const maps::Point step{next.x - now.x, next.y - now.y}, to{cell.x - now.x, cell.y - now.y};
    const double square = std::max(step.x * step.x + step.y * step.y, 1e-9);
    const double back = std::clamp((to.x * step.x + to.y * step.y) / square, -1.0, 0.0);
    return std::hypot(to.x - back * step.x, to.y - back * step.y) <
           0.5 * std::max(each.length, each.width) + around;
  };
  for (std::size_t i = 0; i < grid_.cells.size(); ++i) {
    if (grid_.cells[i] != maps::Occupancy::occupied && prices_[i] == 0) continue;
    const auto row = i / static_cast<std::size_t>(grid_.width), column = i - row * grid_.width;
    const maps::Point cell{grid_.origin.x + (column + 0.5) * grid_.resolution,
                           grid_.origin.y + (row + 0.5) * grid_.resolution};
    if (std::none_of(others.begin(), others.end(), [&](auto& each) { return is_near(cell, each); })) continue;
    grid_.cells[i] = maps::Occupancy::free;
    prices_[i] = 0;
  }
  costmap_->update(grid_, prices_);
}

void PathFollower::limit_speed(double limit, bool percentage) {
  if (!std::isfinite(limit) || limit < 0)
    throw std::invalid_argument("speed limit: " + to_text(limit) + " must be finite and at least 0");
  limit_ = limit;
  limit_is_percentage_ = percentage;
  find_share();
}

bool PathFollower::cancel() {
  if (!cancelling_) {
    cancelling_ = true;
    cancelling_for_ = 0;
    plan_.clear();
    if (navigator_) navigator_->reset(seed());
  }
  return !navigator_ || stands(velocity_) || cancelling_for_ > longest_braking;
}

void PathFollower::reset() {
  plan_.clear();
  if (navigator_) navigator_->reset(seed());
  cancelling_ = false;
  last_time_.reset();
  velocity_ = command_ = {};
  predicted_.clear();
  path_.clear();
}

std::uint64_t PathFollower::seed() const {
  const SolverOptions solver = settings_.solver(1);
  const std::uint64_t* const seed_of_method = solver.find<std::uint64_t>("seed");
  return seed_of_method ? *seed_of_method : 0;
}

/// Finds the share of the limits that the speed limit leaves.
void PathFollower::find_share() {
  const double before = share_;
  share_ = limit_ == 0
               ? 1.0
               : std::min(limit_is_percentage_ ? limit_ / 100 : limit_ / settings_.max_forward(), 1.0);
  if (share_ != before) navigator_.reset();
}

/// The goal checker decides when the goal is reached; the navigator must not stand before.
void PathFollower::make_navigator(const std::optional<GoalTolerance>& told) {
  if (navigator_ && told == tolerance_) return;
  nav::NavigatorOptions options = settings_.navigator(share_);
  constexpr double least = 0.001, every_heading = 4;  // least and largest values that the navigator takes
  if (told && told->distance > 0)
    options.goal_distance = std::clamp(told->distance, least, options.goal_distance);
  if (told)
    options.goal_angle = told->angle > 0 ? std::clamp(told->angle, least, options.goal_angle) : every_heading;
  navigator_.emplace(*footprint_, options, settings_.solver(share_), *costmap_);
  if (!own_costs_.empty())
    navigator_->set_cost([terms = own_costs_](const nav::RolloutStates& states, std::span<double> costs) {
      for (const auto& [name, add] : terms) add(states, costs);
    });
  tolerance_ = told;
  placed_frame_.reset();
}

/// Gives the navigator the plan ahead of the robot, where the frame of the plan is now. Localisation moves
/// that frame against the costmap.
void PathFollower::place_plan(const maps::Pose& plan_frame) {
  const auto moves = [&](const maps::Pose& pose) {
    return maps::distance(maps::transform(plan_frame, {pose.x, pose.y}),
                          maps::transform(*placed_frame_, {pose.x, pose.y})) > notable;
  };
  if (placed_frame_ && !moves(plan_.front()) && !moves(plan_.back())) return;
  placed_frame_ = plan_frame;
  std::vector<maps::Pose> placed;
  double left = 0;
  for (std::size_t i = plan_.size(); i-- > 0 && left <= remaining_ + behind;) {
    const maps::Point at = maps::transform(plan_frame, {plan_[i].x, plan_[i].y});
    if (!placed.empty()) left += maps::distance(at, {placed.back().x, placed.back().y});
    placed.push_back({at.x, at.y, plan_[i].yaw + plan_frame.yaw});
  }
  std::reverse(placed.begin(), placed.end());
  navigator_->set_path(placed);
}

double PathFollower::elapsed_until(double time) {
  const double since = last_time_ ? time - *last_time_ : usual_period;
  last_time_ = time;
  return since > 0 && since < longest_period ? since : usual_period;
}

FollowerAnswer PathFollower::update(const FollowerInput& input) try {
  const double elapsed = elapsed_until(input.time);
  velocity_ = settings_.own().open_loop ? command_ : input.velocity;
  if (plan_.empty() && !cancelling_) return {Problem::invalid_path, "no path was set", "", {}, 0};
  if (!costmap_) return {Problem::no_control, "there is no costmap", "", {}, 0};
  if (!footprint_) return {Problem::no_control, "the robot has no footprint", "", {}, 0};
  make_navigator(input.tolerance);
  if (!plan_.empty()) place_plan(input.plan_frame);
  const std::span<const maps::PredictedObstacle> others = others_from() == OthersFrom::none
                                                              ? std::span<const maps::PredictedObstacle>{}
                                                              : people_.predict(input.time);
  clear(others);
  const nav::NavigationResult result = navigator_->update(input.pose, velocity_, *costmap_, elapsed, others);
  predicted_.assign(result.plan.begin(), result.plan.end());
  path_.assign(result.path.begin(), result.path.end());
  const FollowerAnswer answer = judge(result, elapsed);
  command_ = answer.command;
  remaining_ = result.remaining;
  return answer;
} catch (const std::exception& error) {
  command_ = {};
  return {Problem::no_control, error.what(), "", {}, 0};
}

std::vector<CostTerm> PathFollower::cost_terms() const {
  if (predicted_.empty()) return {};
  const auto none = detail::cost_terms_of<nav::NavigationProblem<nav::DifferentialBase>>();
  std::vector<CostTerm> terms(none.begin(), none.end());
  const Trajectories plan = navigator_->roll_out(navigator_->solution().inputs);
  for (std::size_t i = 0; i < plan.costs.size(); ++i) terms[i % none.size()].value += plan.costs[i];
  for (const auto& [name, add] : own_costs_) {
    double cost = 0;
    for (int k = 0; k + 1 < static_cast<int>(predicted_.size()); ++k) {
      const std::span at = std::span(plan.states).subspan(6 * static_cast<std::size_t>(k), 12);
      add({k, at.first(1), at.subspan(1, 1), at.subspan(2, 1), at.subspan(9, 1), at.subspan(10, 1),
           at.last(1)},
          {&cost, 1});
    }
    terms.push_back({name.c_str(), settings_.navigator(1).time_step * cost});
  }
  return terms;
}

std::vector<maps::Point> PathFollower::samples(int most) const {
  const SequenceBatch* const drawn = predicted_.empty() ? nullptr : navigator_->solution().samples;
  if (!drawn) return {};
  std::vector<float> sequences;
  for (int sample = 0; sample < drawn->samples(); sample += std::max(drawn->samples() / most, 1))
    for (int row = 0; row < drawn->rows(); ++row) sequences.push_back(drawn->data(row)[sample]);
  const std::vector<double> states = navigator_->roll_out(sequences).states;
  constexpr std::size_t size = 6;  // values of a state, which begin with x and y
  std::vector<maps::Point> lines;
  for (std::size_t i = 1; i < states.size() / size; ++i)
    if (i % predicted_.size() != 0)
      for (const double* end : {&states[size * (i - 1)], &states[size * i]})
        lines.push_back({end[0], end[1]});
  return lines;
}

FollowerAnswer PathFollower::judge(const nav::NavigationResult& result, double elapsed) {
  FollowerAnswer answer{
      .status = nav::name(result.status), .command = result.command, .remaining = result.remaining};
  if (cancelling_) {  // without a path the navigator brakes
    cancelling_for_ += elapsed;
    return answer;
  }
  answer.why = why_of(result.status);
  if (answer.why.empty()) return answer;
  answer.problem = Problem::no_control;
  answer.command = {};
  return answer;
}

}  // namespace slalom::nodes
