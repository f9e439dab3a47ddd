#include "slalom/navigation/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "navigation/base_model.hpp"
#include "navigation/command_delay.hpp"
#include "navigation/others.hpp"
#include "navigation/way.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::navigation {
namespace {

constexpr int steps_to_react = 2;       // steps of a plan, beside those of braking, that must be free
constexpr int first_solves = 5;         // solves of the first plan on a leg
constexpr double least_command = 0.05;  // m/s and rad/s, of commands that move a robot
constexpr double share_followed = 0.2;  // least share of a command that a robot follows
constexpr double ignored_after = 0.8;   // s
constexpr int longest_stop = 100;       // steps of braking that are checked
constexpr double max_period = 0.2;      // s for which the robot brakes in one command

bool plausible(const Velocity& v) {
  return std::abs(v.forward) <= Velocity::largest && std::abs(v.left) <= Velocity::largest &&
         std::abs(v.turn) <= Velocity::largest;
}

/// The time (s) in which a robot brakes to 0, on a straight line.
double braking_time(const Velocity& v, const BaseOptions& base) {
  const auto [forward, sideways, turning] = axis_limits(base);
  return std::max(std::abs(v.forward) / forward.deceleration, std::abs(v.left) / sideways.deceleration);
}

/// The velocity after braking for a while (s).
Velocity braked(const Velocity& v, const BaseOptions& base, double period) {
  const double time = braking_time(v, base), kept = time > 0 ? std::max(1 - period / time, 0.0) : 0;
  const double turn = std::max(std::abs(v.turn) - axis_limits(base)[2].deceleration * period, 0.0);
  return {kept * v.forward, kept * v.left, std::copysign(turn, v.turn)};
}

/// The last step of an update: makes the command finite and moves it into the limits of the base. Counts the
/// changed values in `corrections`. Commands in a dead band are 0.
void check_result(NavigationResult& result, const BaseOptions& base) noexcept {
  const auto check = [&](double& value, double least, double most, double dead_band) {
    const double valid = std::clamp(std::isfinite(value) ? value : 0.0, least, most);
    result.corrections += valid != value;
    value = std::abs(valid) < dead_band ? 0 : valid;
  };
  const double sideways = base.kind == BaseKind::omnidirectional ? base.max_sideways : 0;
  check(result.command.forward, -base.max_reverse, base.max_forward, base.dead_band_forward);
  check(result.command.left, -sideways, sideways, base.dead_band_sideways);
  check(result.command.turn, -base.max_turn, base.max_turn, base.dead_band_turn);
}

}  // namespace

class Navigator::Implementation {
 public:
  Implementation(const Footprint& footprint, const NavigatorOptions& options, const SolverOptions& solver,
                 const Costmap& costmap)
      : options_((validate_options(options, "navigator"), options)),
        footprint_(footprint),
        core_(footprint.without_rim(0.5 * costmap.geometry().resolution)),
        geometry_(costmap.geometry()),
        model_(detail::make_base_model(options, footprint, geometry_.resolution, solver)),
        way_(options, footprint, geometry_,
             model_->plan().size() * options.time_step *
                 std::max({options.base.max_forward, options.base.max_reverse, options.base.max_sideways})),
        delay_(options.base),
        others_(footprint, options, model_->plan().size() - 1) {}

  std::unique_ptr<Implementation> clone() const { return std::make_unique<Implementation>(*this); }

  NavigationResult update(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                          double elapsed, std::span<const maps::PredictedObstacle> others) noexcept;
  void reset(std::uint64_t seed) noexcept;

 private:
  friend Navigator;
  bool fits(const Costmap& costmap) const noexcept;
  bool watch_commands(const Velocity& velocity, double elapsed) noexcept;
  double room_at(const Costmap& costmap, const maps::Pose& pose) const noexcept;
  bool plan_collides(const Costmap& costmap, const Velocity& velocity) const noexcept;
  NavigationResult plan(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                        double elapsed) noexcept;
  NavigationResult stand(NavigationStatus status, const Velocity& velocity, double elapsed) const noexcept;

  NavigatorOptions options_;
  Footprint footprint_, core_;
  maps::GridGeometry geometry_;
  Polymorphic<detail::BaseModel> model_;
  detail::Way way_;
  detail::CommandDelay delay_;
  detail::Others others_;
  NavigationMaps maps_;
  double since_solve_ = 0;  ///< s
  double ignored_for_ = 0;  ///< s for which the robot does not follow the commands
  Velocity command_;        ///< the last one
};

void Navigator::Implementation::reset(std::uint64_t seed) noexcept {
  way_.clear();
  others_.clear();
  delay_.clear();
  since_solve_ = ignored_for_ = 0;
  command_ = {};
  model_->reset(seed);
}

bool Navigator::Implementation::fits(const Costmap& costmap) const noexcept {
  const maps::GridGeometry& g = costmap.geometry();
  return g.rows == geometry_.rows && g.columns == geometry_.columns && g.resolution == geometry_.resolution;
}

/// Whether the velocity has stayed near 0 for a while although the commands did not.
bool Navigator::Implementation::watch_commands(const Velocity& velocity, double elapsed) noexcept {
  const double asked = std::hypot(command_.forward, command_.left),
               driven = std::hypot(velocity.forward, velocity.left);
  const bool drives = asked > least_command && driven < share_followed * asked;
  const bool turns = std::abs(command_.turn) > least_command &&
                     std::abs(velocity.turn) < share_followed * std::abs(command_.turn);
  const bool moves = driven > least_command || std::abs(velocity.turn) > least_command;
  ignored_for_ = (drives || turns) && !moves ? ignored_for_ + elapsed : 0;
  return ignored_for_ > ignored_after + delay_.longest();
}

/// The room of a body that overlaps an obstacle, m: the less, the deeper it is in it.
double Navigator::Implementation::room_at(const Costmap& costmap, const maps::Pose& pose) const noexcept {
  double room = std::numeric_limits<double>::infinity();
  for (const Footprint::Part& part : footprint_.parts()) {
    const maps::Point middle = maps::transform(pose, part.middle);
    room = std::min(room, costmap.distance(middle.x, middle.y) - part.contained);
  }
  return room;
}

/// Whether the plan meets a fixed or moving obstacle before the robot could brake. A body that
/// overlaps an obstacle already may leave it, but not go deeper into it: where it does so by less than half a
/// cell, as scans may err, the body without such a rim must stay free.
bool Navigator::Implementation::plan_collides(const Costmap& costmap,
                                              const Velocity& velocity) const noexcept {
  const std::span<const maps::Pose> plan = model_->plan();
  const double braking = braking_time(velocity, options_.base) / options_.time_step;
  const std::size_t last = std::min(
      plan.size() - 1, saturate_cast<std::size_t>(std::min(std::ceil(braking), 1e6)) + steps_to_react);
  if (others_.meet(plan, last)) return true;
  if (maps_.overlaps && costmap.collides(core_, plan.front())) {
    const double begin = room_at(costmap, plan.front());
    return std::any_of(plan.begin() + 1, plan.begin() + last + 1,
                       [&](const maps::Pose& pose) { return room_at(costmap, pose) < begin; });
  }
  const Footprint& body = maps_.overlaps ? core_ : footprint_;
  for (std::size_t i = 1; i <= last; ++i)
    if (costmap.collides(body, plan[i - 1], plan[i])) return true;
  // After the first step the robot can still stop: speed and yaw rate fall by their own limits.
  Velocity v = model_->command();
  maps::Pose at = plan.front();
  const double step = options_.time_step;
  for (int i = 0; i < longest_stop && (v.forward != 0 || v.left != 0 || v.turn != 0); ++i) {
    const double yaw = at.yaw + 0.5 * step * v.turn, c = std::cos(yaw), s = std::sin(yaw);
    const maps::Pose next{at.x + step * (c * v.forward - s * v.left),
                          at.y + step * (s * v.forward + c * v.left), at.yaw + step * v.turn};
    if (costmap.collides(body, at, next)) return true;
    at = next;
    v = braked(v, options_.base, step);
  }
  return false;
}

/// Brakes, or stands.
NavigationResult Navigator::Implementation::stand(NavigationStatus status, const Velocity& velocity,
                                                  double elapsed) const noexcept {
  NavigationResult result;
  result.status = status;
  if (!plausible(velocity)) return result;
  result.command = braked(velocity, options_.base, std::clamp(elapsed, 0.0, max_period));
  return result;
}

NavigationResult Navigator::Implementation::update(const maps::Pose& now, const Velocity& told,
                                                   const Costmap& costmap, double elapsed,
                                                   std::span<const maps::PredictedObstacle> others) noexcept {
  if (!maps::is_plausible(now) || !plausible(told) || !(elapsed >= 0) || !std::isfinite(elapsed) ||
      !fits(costmap))
    return stand(NavigationStatus::bad_input, told, std::isfinite(elapsed) ? elapsed : 0);
  since_solve_ += elapsed;
  if (way_.empty() || costmap.geometry().row(now.x) < 0 || costmap.geometry().column(now.y) < 0)
    return stand(NavigationStatus::no_path, told, elapsed);
  const bool ignored = watch_commands(told, elapsed);
  // Decisions are made for the place where they take effect.
  delay_.pass(told, elapsed);
  const bool delayed = delay_.longest() > 0;
  const maps::Pose pose = delayed ? delay_.predict(now) : now;
  const Velocity velocity = delayed ? delay_.decided() : told;
  way_.advance(pose, velocity, costmap, elapsed);
  others_.update(others, {pose.x, pose.y});
  if (way_.ends_at(pose)) {
    const bool is_there = way_.has_ended(now);
    return stand(is_there ? NavigationStatus::goal_reached : NavigationStatus::following, velocity, elapsed);
  }
  const bool has_way = way_.keep(pose, velocity, costmap, others_, elapsed);
  if (way_.is_stuck()) return stand(NavigationStatus::stuck, velocity, elapsed);
  if (!has_way) return stand(NavigationStatus::blocked, velocity, elapsed);
  way_.advance(pose, velocity, costmap, 0);
  if (way_.is_at_stop()) return stand(NavigationStatus::goal_occupied, velocity, elapsed);
  NavigationResult result = plan(pose, velocity, costmap, elapsed);
  if (ignored) result.status = NavigationStatus::commands_ignored;
  return result;
}

/// Solves and checks the plan.
NavigationResult Navigator::Implementation::plan(const maps::Pose& pose, const Velocity& velocity,
                                                 const Costmap& costmap, double elapsed) noexcept {
  maps_.distances = costmap.distances();
  maps_.prices = costmap.prices();
  maps_.others = others_.view();
  maps_.overlaps = costmap.collides(footprint_, pose);
  way_.write(pose, maps_);
  // The plan of another leg is no use on this one: its first plan takes several solves.
  for (int solves = way_.takes_leg() ? first_solves : 1; solves > 0; --solves) {
    model_->solve(maps_, pose, velocity, since_solve_);
    since_solve_ = 0;
  }
  NavigationResult result;
  if (plan_collides(costmap, velocity)) {
    result = stand(NavigationStatus::braking, velocity, elapsed);
  } else {
    result.command = model_->command();
    result.status = way_.is_detour() ? NavigationStatus::detour : NavigationStatus::following;
  }
  result.plan = model_->plan();
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
  implementation_->way_.set_path(path);
}

NavigationResult Navigator::update(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                                   double elapsed, std::span<const maps::PredictedObstacle> others) noexcept {
  Implementation& own = *implementation_;
  NavigationResult result = own.update(pose, velocity, costmap, elapsed, others);
  check_result(result, own.options_.base);
  result.command = own.command_ = own.delay_.send(result.command);
  result.delay = own.delay_.longest();
  result.remaining = own.way_.remaining();
  result.path = own.way_.points();
  return result;
}

void Navigator::set_cost(StateCost cost) noexcept {
  implementation_->model_->set_cost(std::move(cost));
}

const SolveResult& Navigator::solution() const noexcept {
  return implementation_->model_->solution();
}

Trajectories Navigator::roll_out(std::span<const float> sequences) const {
  return implementation_->model_->roll_out(sequences);
}

void Navigator::reset(std::uint64_t seed) noexcept {
  implementation_->reset(seed);
}

}  // namespace slalom::navigation
