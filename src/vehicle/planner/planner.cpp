#include "slalom/vehicle/planner/planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "slalom/core/final_check.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "vehicle/planner/map_options.hpp"
#include "vehicle/planner/planner_base.hpp"

namespace slalom::vehicle {
namespace detail {
namespace {

/// Throws std::invalid_argument unless a planner can be made from these parts.
void check_parts(const PlannerOptions& options, const VehicleModel* model,
                 std::span<const maps::ReferencePoint> path, const Solver* solver) {
  validate_options(options, "planner");
  if (!model) throw std::invalid_argument("planner: model must not be null");
  if (!solver) throw std::invalid_argument("planner: solver must not be null");
  if (options.latency + model->traits().dead_time > 32 * options.control_period) {
    throw std::invalid_argument(
        "planner.latency: together with vehicle.dead_time must be at most 32 control periods");
  }
  if (solver->inputs() != model->inputs()) {
    throw std::invalid_argument("planner: solver has " + std::to_string(solver->inputs()) +
                                " inputs per step, must have " + std::to_string(model->inputs()) +
                                ", like the vehicle model");
  }
  maps::check_reference_path(path);
}

/// Returns the point of a 100 km grid that is nearest to the path's first point, m; (0, 0) for most courses.
/// The planner works relative to this point. Subtracting it from a coordinate is exact, whereas sums of UTM
/// coordinates (5e6 m, which double resolves to 1e-9 m) would round differently from sums near (0, 0).
maps::Point grid_origin(std::span<const maps::ReferencePoint> path) {
  const double grid = maps::PoseLimits::position / 100;
  return {grid * std::round(path[0].x / grid), grid * std::round(path[0].y / grid)};
}

/// The points of a path relative to `origin`, without those that are less than 1 mm from the one before: a
/// car that stands while it is recorded leaves thousands, and each update walks along the path.
std::vector<maps::ReferencePoint> thinned(std::span<const maps::ReferencePoint> path,
                                          const maps::Point& origin) {
  std::vector<maps::ReferencePoint> kept;
  for (maps::ReferencePoint point : path) {
    point.x -= origin.x;
    point.y -= origin.y;
    if (kept.empty() || std::hypot(point.x - kept.back().x, point.y - kept.back().y) >= 1e-3)
      kept.push_back(point);
  }
  return kept;
}

/// Moves predicted states, which are relative to `origin`, to the map frame.
void shift(std::span<PredictedState> states, const maps::Point& origin) noexcept {
  for (PredictedState& state : states) {
    state.pose.x += origin.x;
    state.pose.y += origin.y;
  }
}

/// Whether odometry is finite and within the limits of `Odometry`.
bool plausible(const Odometry& o) {
  return maps::is_plausible(o.pose) && std::abs(o.speed) <= Odometry::fastest;
}

/// Moves a value into a range; one that is not finite becomes `otherwise`. Returns 1 if it changed, else 0.
int check_value(double& value, double least, double most, double otherwise) noexcept {
  const double valid = std::clamp(std::isfinite(value) ? value : otherwise, least, most);
  const bool changed = valid != value;
  value = valid;
  return static_cast<int>(changed);
}

}  // namespace

PlannerBase::PlannerBase(PlannerParts& parts)
    : options_(parts.options),
      origin_(parts.origin),
      model_(std::move(parts.model)),
      traits_(model_->traits()),
      solver_(std::move(parts.solver)),
      stopping_time_(stopping_time(parts.path, options_, traits_)),
      reach_(plan_reach(parts.path, options_, traits_, horizon_time() + stopping_time_)),
      obstacles_(options_, traits_, solver_->horizon(), reach_),
      field_(limited_path(parts.path, options_, traits_), field_options(options_, traits_, reach_)),
      choice_(solver_->horizon(), solver_->inputs(), traits_) {
  solver_->connect(model_->evaluator());
}

const PlannerOutput& PlannerBase::update(const PlannerInput& input) noexcept {
  const auto begin = std::chrono::steady_clock::now();
  const bool placed = plausible(input.odometry);
  top_speed_ = input.goal_speed >= 0.0 ? std::min(*input.goal_speed, options_.max_speed) : options_.max_speed;
  output_.scan = obstacles_.update(input, placed);
  output_.steer_estimate = steer_estimate();
  brakes_ = false;
  const bool sees = output_.scan.accepted && output_.scan.invalid < output_.scan.beams;
  if (!placed) {
    stop(PlannerStatus::bad_odometry);
  } else if (!sees || input.scan.ranges.size() < 2) {
    stop(PlannerStatus::bad_scan);
  } else {
    PlannerInput local = input;
    local.odometry.pose.x -= origin_.x;
    local.odometry.pose.y -= origin_.y;
    plan(local);
    shift(choice_.states(), origin_);
  }
  output_.corrections = check_command(input.odometry, steer_estimate());
  const bool obeys_other =
      input.obeyed && std::isfinite(input.obeyed->steer) && std::isfinite(input.obeyed->speed);
  send(obeys_other ? input.obeyed : std::nullopt);
  check_output(input.odometry);
  output_.tick_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return output_;
}

void PlannerBase::stop(PlannerStatus status) noexcept {
  brakes_ = true;
  output_.status = status;
  output_.command = {steer_estimate(), 0};
  output_.inputs = {};
  output_.predicted = {};
  output_.solve = nullptr;
  output_.state_cost = output_.collision_cost = 0;
}

bool PlannerBase::must_stop(const maps::ReferenceCell& here) const noexcept {
  return traits_.speed.follows_path && options_.stop_when_blocked &&
         here.distance >= field_.options().outside.distance;
}

void PlannerBase::begin_rollouts(const maps::Pose& robot, const VehicleStart& start,
                                 double path_speed) noexcept {
  rollouts_ = {robot, start, path_speed};
  take_own_maps();
}

void PlannerBase::take_own_maps() noexcept {
  if (!rollouts_) return;
  model_->set_maps(obstacles_.seen_from(rollouts_->robot, followed(), origin_));
  model_->set_start(rollouts_->start, traits_.speed.follows_path
                                          ? rollouts_->path_speed
                                          : std::min(traits_.speed.reference, top_speed_));
}

const SolveResult& PlannerBase::solve() noexcept {
  SolveRequest request{.elapsed = options_.control_period};
  if (options_.deadline > 0) request.deadline = options_.deadline;
  const SolveResult& result = solver_->solve(model_->evaluator(), request);
  output_.solve = &result;
  output_.status = result.status == Status::degenerate ? PlannerStatus::solver_degenerate : PlannerStatus::ok;
  return result;
}

void PlannerBase::publish() noexcept {
  const SequenceChoice::Choice& chosen = choice_.best();
  output_.inputs = chosen.inputs;
  output_.inputs_per_step = model_->inputs();
  output_.predicted = choice_.states();
  output_.state_cost = chosen.cost.state;
  output_.collision_cost = chosen.cost.collision;
}

/// Moves the command into its limits. A steering angle that is not finite becomes `wheels` (rad), and a speed
/// that is not finite becomes 0. Returns the number of values that were changed.
int PlannerBase::check_command(const Odometry& odometry, double wheels) noexcept {
  const double now = std::isfinite(odometry.speed) ? std::max(odometry.speed, 0.0) : 0;
  const double fastest = brakes_ ? std::min(now, options_.max_speed) : options_.max_speed;
  return check_value(output_.command.steer, -options_.steer_limit, options_.steer_limit,
                     std::isfinite(wheels) ? wheels : 0) +
         check_value(output_.command.speed, slowest(), fastest, 0);
}

/// The last step before an output leaves the planner. Checks the command again and sets estimates that are
/// not finite to 0. If a cost or an input is not finite, the output has no prediction, and a status that
/// claims a plan becomes `solver_degenerate`. Such costs become the largest double, such inputs are left out.
void PlannerBase::check_output(const Odometry& odometry) noexcept {
  const double most = std::numeric_limits<double>::max();
  PlannerOutput& out = output_;
  out.corrections += check_command(odometry, out.steer_estimate);
  for (double* const estimate :
       {&out.steer_estimate, &out.speed_estimate, &out.yaw_rate_estimate, &out.slip_estimate})
    out.corrections += check_value(*estimate, -most, most, 0);
  const bool finite =
      std::all_of(out.inputs.begin(), out.inputs.end(), [](float u) { return std::isfinite(u); });
  if (!finite) out.inputs = {};
  const int changed = check_cost(out.state_cost) + check_cost(out.collision_cost) + (finite ? 0 : 1);
  if (changed == 0) return;
  out.corrections += changed;
  out.predicted = {};
  if (out.status == PlannerStatus::ok || out.status == PlannerStatus::fallback_plan)
    out.status = PlannerStatus::solver_degenerate;
}

void PlannerBase::reset(std::uint64_t seed) noexcept {
  top_speed_ = options_.max_speed;
  forget();
  choice_.reset();
  solver_->reset(seed);
  field_.reset();
  obstacles_.reset();
  rollouts_.reset();
  output_ = {};
}

PredictedCost PlannerBase::predict(std::span<const float> inputs,
                                   std::span<PredictedState> states) const noexcept {
  if (!rollouts_) return {};
  const PredictedCost cost = model_->predict(inputs, states);
  shift(states.first(inputs.size() / static_cast<std::size_t>(model_->inputs()) + 1), origin_);
  return cost;
}

}  // namespace detail

Planner::Planner(const PlannerOptions& options, std::unique_ptr<VehicleModel> model,
                 std::span<const maps::ReferencePoint> path, std::unique_ptr<Solver> solver) {
  detail::check_parts(options, model.get(), path, solver.get());
  const bool slips = dynamic_cast<const DynamicVehicleModel*>(model.get());
  const maps::Point origin = detail::grid_origin(path);
  detail::PlannerParts parts{options, std::move(model), origin, detail::thinned(path, origin),
                             std::move(solver)};
  implementation_ = slips ? detail::make_dynamic_planner(parts) : detail::make_kinematic_planner(parts);
}

Planner::~Planner() = default;
Planner::Planner(const Planner& other) : implementation_(other.implementation_->clone()) {
  implementation_->take_own_maps();
}
Planner& Planner::operator=(const Planner& other) {
  return *this = Planner(other);
}
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

const PlannerOutput& Planner::update(const PlannerInput& input) noexcept {
  return implementation_->update(input);
}
void Planner::reset(std::uint64_t seed) noexcept {
  implementation_->reset(seed);
}
PredictedCost Planner::predict(std::span<const float> inputs,
                               std::span<PredictedState> states) const noexcept {
  return implementation_->predict(inputs, states);
}
const Solver& Planner::solver() const noexcept {
  return implementation_->solver();
}
const maps::LocalCostMap& Planner::cost_map() const noexcept {
  return implementation_->cost_map();
}

}  // namespace slalom::vehicle
