#include "slalom/navigation/navigator.hpp"

#include <algorithm>
#include <cmath>
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
constexpr double share_followed = 0.2;  // least share of a command that a robot follows
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

/// The velocity after braking for a period (s).
Velocity braked(const Velocity& v, const BaseOptions& base, double period) {
  period = std::isfinite(period) ? std::clamp(period, 0.0, max_period) : 0;
  const double time = braking_time(v, base), kept = time > 0 ? std::max(1 - period / time, 0.0) : 0;
  const double turn = std::max(std::abs(v.turn) - axis_limits(base)[2].deceleration * period, 0.0);
  return {kept * v.forward, kept * v.left, std::copysign(turn, v.turn)};
}

/// The last step of an update: makes the command finite and moves it into the limits of the base, or brakes
/// to them. Counts the changed values in `corrections`. Commands in a dead band are 0.
void check_result(NavigationResult& result, const BaseOptions& base, const Velocity& slowest) noexcept {
  const auto check = [&](double& value, double least, double most, double dead_band, double braking) {
    const double valid =
        std::clamp(std::isfinite(value) ? value : 0.0, std::min(least, braking), std::max(most, braking));
    result.corrections += valid != value;
    value = std::abs(valid) < dead_band ? 0 : valid;
  };
  const double sideways = base.kind == BaseKind::omnidirectional ? base.max_sideways : 0;
  check(result.command.forward, -base.max_reverse, base.max_forward, base.dead_band_forward, slowest.forward);
  check(result.command.left, -sideways, sideways, base.dead_band_sideways, sideways > 0 ? slowest.left : 0);
  check(result.command.turn, -base.max_turn, base.max_turn, base.dead_band_turn, slowest.turn);
}

}  // namespace

class Navigator::Implementation {
 public:
  Implementation(const Footprint& footprint, const NavigatorOptions& options, const SolverOptions& solver,
                 const Costmap& costmap)
      : options_((validate_options(options, "navigator"), options)),
        bodies_(footprint.without_rims(0.5 * costmap.geometry().resolution)),
        geometry_(costmap.geometry()),
        model_(detail::make_base_model(options, footprint, geometry_.resolution, solver)),
        way_(options, footprint, geometry_,
             model_->plan().size() * options.time_step *
                     std::max(
                         {options.base.max_forward, options.base.max_reverse, options.base.max_sideways}) +
                 options.base.max_forward * 0.5 *
                     braking_time({options.base.max_forward, 0, 0}, options.base)),
        delay_(options.base),
        others_(footprint, options, model_->plan().size() - 1, geometry_.resolution) {}

  std::unique_ptr<Implementation> clone() const { return std::make_unique<Implementation>(*this); }

  NavigationResult update(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                          double elapsed, std::span<const maps::PredictedObstacle> others) noexcept;
  void reset(std::uint64_t seed) noexcept;

 private:
  friend Navigator;
  Velocity believe(const Velocity& told) noexcept;
  bool watch_commands(const Velocity& velocity, double elapsed) noexcept;
  bool plan_collides(const Costmap& costmap, const Velocity& velocity) const noexcept;
  NavigationResult plan(const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                        double elapsed) noexcept;
  NavigationResult stand(NavigationStatus status, const Velocity& velocity, double elapsed) const noexcept;

  NavigatorOptions options_;
  std::vector<Footprint> bodies_;  ///< by the rim that they lack
  maps::GridGeometry geometry_;
  Polymorphic<detail::BaseModel> model_;
  detail::Way way_;
  detail::CommandDelay delay_;
  detail::Others others_;
  NavigationMaps maps_;
  double since_solve_ = 0;  ///< s
  double ignored_for_ = 0;  ///< s for which the robot does not follow the commands
  Velocity command_;        ///< the last one
  Velocity told_{Velocity::largest, Velocity::largest, Velocity::largest};  ///< in the last update
};

void Navigator::Implementation::reset(std::uint64_t seed) noexcept {
  way_.clear();
  others_.clear();
  delay_.clear();
  since_solve_ = ignored_for_ = 0;
  command_ = {};
  told_ = {Velocity::largest, Velocity::largest, Velocity::largest};
  model_->reset(seed);
}

/// The velocity that was told; a robot drives faster than its limits only if it did so before.
Velocity Navigator::Implementation::believe(const Velocity& told) noexcept {
  if (!plausible(told)) return told;
  const auto axis = [](double now, double before, double limit) {
    const double most = std::max(limit, std::abs(before));
    return std::clamp(now, -most, most);
  };
  const BaseOptions& base = options_.base;
  const Velocity before = std::exchange(told_, told);
  return {axis(told.forward, before.forward, std::max(base.max_forward, base.max_reverse)),
          axis(told.left, before.left, base.max_sideways), axis(told.turn, before.turn, base.max_turn)};
}

/// Whether the velocity has stayed near 0 for a while although the commands did not.
bool Navigator::Implementation::watch_commands(const Velocity& velocity, double elapsed) noexcept {
  const double asked = std::hypot(command_.forward, command_.left),
               driven = std::hypot(velocity.forward, velocity.left);
  // Changes within a step of a plan do not count.
  const auto [forward, sideways, turning] = axis_limits(options_.base);
  const double share = share_followed * options_.time_step, least = share * forward.acceleration,
               least_turn = share * turning.acceleration, turned = std::abs(velocity.turn);
  const bool drives = asked > least && driven < share_followed * asked;
  const bool turns =
      std::abs(command_.turn) > least_turn && turned < share_followed * std::abs(command_.turn);
  ignored_for_ = (drives || turns) && driven <= least && turned <= least_turn ? ignored_for_ + elapsed : 0;
  return ignored_for_ > options_.stuck_after / 5 + delay_.longest();
}

/// Whether the plan meets a fixed or moving obstacle before the robot could brake. A body in an obstacle may
/// leave it, not go deeper: it must stay free without the rim that overlaps, or where the robot stands, half
/// a cell more, which rollouts do not see. If even its core is in an obstacle, the plan must leave it.
bool Navigator::Implementation::plan_collides(const Costmap& costmap,
                                              const Velocity& velocity) const noexcept {
  const std::span<const maps::Pose> plan = model_->plan();
  const double braking = braking_time(velocity, options_.base) / options_.time_step;
  const std::size_t last = std::min(
      plan.size() - 1, saturate_cast<std::size_t>(std::min(std::ceil(braking), 1e6)) + steps_to_react);
  if (others_.meet(plan, last)) return true;
  const int rim = maps_.rim > 0 && way_.stands() ? maps_.rim + 1 : maps_.rim;
  const Footprint& body = bodies_[std::min(rim, static_cast<int>(bodies_.size()) - 1)];
  if (costmap.collides(body, plan.front())) return costmap.collides(body, plan.back());
  for (std::size_t i = 1; i <= last; ++i)
    if (costmap.collides(body, plan[i - 1], plan[i])) return true;
  // After the first step the robot can still stop: speed and yaw rate fall by their own limits.
  Velocity v = model_->command();
  maps::Pose at = plan.front();
  const double step =
      std::max(options_.time_step, braking_time(v, options_.base) / static_cast<double>(plan.size()));
  for (std::size_t i = 0; i < 2 * plan.size() && (v.forward != 0 || v.left != 0 || v.turn != 0); ++i) {
    const maps::Pose next = moved(at, v, step);
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
  if (plausible(velocity)) result.command = braked(velocity, options_.base, elapsed);
  return result;
}

NavigationResult Navigator::Implementation::update(const maps::Pose& now, const Velocity& told,
                                                   const Costmap& costmap, double elapsed,
                                                   std::span<const maps::PredictedObstacle> others) noexcept {
  if (!maps::is_plausible(now) || !plausible(told) || !(elapsed >= 0) || !std::isfinite(elapsed) ||
      costmap.geometry().resolution != geometry_.resolution || costmap.geometry().rows != geometry_.rows ||
      costmap.geometry().columns != geometry_.columns)
    return stand(NavigationStatus::bad_input, told, elapsed);
  since_solve_ += elapsed;
  if (way_.empty() || costmap.geometry().row(now.x) < 0 || costmap.geometry().column(now.y) < 0)
    return stand(NavigationStatus::no_path, told, elapsed);
  const bool ignored = watch_commands(told, elapsed);
  // Decisions are made for the place where they take effect.
  delay_.pass(told, elapsed);
  const bool delayed = delay_.longest() > 0;
  const maps::Pose pose = delayed ? delay_.predict(now) : now;
  const Velocity velocity = delayed ? delay_.decided() : delay_.likely();
  way_.advance(pose, velocity, costmap, elapsed);
  others_.update(others, now, costmap, elapsed);
  if (way_.ends_at(pose)) {
    const bool is_there = way_.has_ended(now);
    return stand(is_there ? NavigationStatus::goal_reached : NavigationStatus::following, velocity, elapsed);
  }
  const bool has_way = way_.keep(pose, costmap, others_, elapsed);
  if (way_.is_stuck()) return stand(NavigationStatus::stuck, velocity, elapsed);
  if (!has_way) return stand(NavigationStatus::blocked, velocity, elapsed);
  way_.advance(pose, velocity, costmap, 0);
  if (way_.is_at_stop()) return stand(NavigationStatus::goal_occupied, velocity, elapsed);
  NavigationResult result = plan(pose, velocity, costmap, elapsed);
  if (way_.stands()) result.status = NavigationStatus::waiting;
  if (ignored) result.status = NavigationStatus::commands_ignored;
  return result;
}

/// Solves and checks the plan.
NavigationResult Navigator::Implementation::plan(const maps::Pose& pose, const Velocity& velocity,
                                                 const Costmap& costmap, double elapsed) noexcept {
  maps_.distances = costmap.distances();
  maps_.prices = costmap.prices();
  maps_.others = others_.view();
  maps_.rim = 0;
  while (maps_.rim + 1 < static_cast<int>(bodies_.size()) && costmap.collides(bodies_[maps_.rim], pose))
    ++maps_.rim;
  way_.write(pose, maps_);
  model_->solve(maps_, pose, velocity, since_solve_);
  since_solve_ = 0;
  NavigationResult result;
  bool collides = plan_collides(costmap, velocity);
  for (int again = 0; collides && again < options_.retries; ++again) {
    model_->solve(maps_, pose, velocity, 0);
    collides = plan_collides(costmap, velocity);
  }
  if (collides) {
    // A measurement that is too fast does not put off braking that was asked for.
    const Velocity& asked = delay_.decided();
    const auto slower = [](double v, double limit) {
      return v * limit > 0 && std::abs(limit) < std::abs(v) ? limit : v;
    };
    result = stand(NavigationStatus::braking,
                   {slower(velocity.forward, asked.forward), slower(velocity.left, asked.left),
                    slower(velocity.turn, asked.turn)},
                   elapsed);
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
  const Velocity believed = own.believe(velocity);
  NavigationResult result = own.update(pose, believed, costmap, elapsed, others);
  check_result(result, own.options_.base,
               plausible(believed) ? braked(believed, own.options_.base, elapsed) : Velocity{});
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
