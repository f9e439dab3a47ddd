#include "slalom/vehicle/planner/planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "slalom/maps/reference_field.hpp"
#include "vehicle/planner/back_up.hpp"
#include "vehicle/planner/car_estimator.hpp"
#include "vehicle/planner/command_history.hpp"
#include "vehicle/planner/detour.hpp"
#include "vehicle/planner/feasible_speeds.hpp"
#include "vehicle/planner/final_check.hpp"
#include "vehicle/planner/input_check.hpp"
#include "vehicle/planner/local_frame.hpp"
#include "vehicle/planner/map_options.hpp"
#include "vehicle/planner/obstacles.hpp"
#include "vehicle/planner/recovery.hpp"
#include "vehicle/planner/sequence_choice.hpp"
#include "vehicle/planner/sight.hpp"
#include "vehicle/planner/ways_around.hpp"

namespace slalom::vehicle {
using namespace detail;

struct Planner::Implementation {
  PlannerOptions options;
  maps::Point origin;  ///< of the frame that all below works in, in the map frame
  std::unique_ptr<VehicleModel> model;
  VehicleTraits traits;
  std::unique_ptr<Solver> solver;
  double stopping_time;  ///< s, by which maps reach beyond plans at the given friction
  double reach;          ///< m, of maps
  Obstacles obstacles;
  maps::ReferenceField field;
  FeasibleSpeeds speeds;
  Sight sight;
  PathInSight seen;  ///< with `sight_deceleration`
  CarEstimator car;  ///< of models with tyres that slip; others have `history`
  CommandHistory history;
  BackUp back_up;
  Recovery recovery;               ///< of models with tyres that slip; others have `back_up`
  std::unique_ptr<Detour> detour;  ///< of models with tyres that slip
  double planned_steer = 0;        ///< rad, before it was limited
  bool brakes = false;             ///< this update brakes: the command must not be faster than the car
  double path_friction = 0;        ///< of the path's speeds
  double speed_ahead = 0;          ///< m/s, when the next command takes effect
  SequenceChoice choice;
  WaysAround ways;  ///< of models with tyres that slip
  std::vector<PredictedState> states;
  bool has_maps = false;  ///< an update has given the model its maps
  PlannerOutput output;

  Implementation(const PlannerOptions& o, std::unique_ptr<VehicleModel> m,
                 std::span<const maps::ReferencePoint> path, std::unique_ptr<Solver> s)
      : options(o),
        origin(grid_origin(path)),
        model(std::move(m)),
        traits(model->traits()),
        solver(std::move(s)),
        stopping_time(detail::stopping_time(path, o, traits)),
        reach(plan_reach(path, o, traits, traits.time_step * solver->horizon() + stopping_time)),
        obstacles(o, traits, solver->horizon(), reach),
        field(limited_path(relative(path, origin), o, traits), field_options(o, traits, reach)),
        speeds(limited_path(relative(path, origin), o, traits), o.grip_shares.values()),
        sight(relative(path, origin), speeds.length() > 0, reach, o, traits.body),
        car(o, *model),
        history(o.control_period, delay_of(o, traits), o.observer_time_constant, traits.wheelbase),
        choice(solver->horizon(), solver->inputs(), traits),
        ways(relative(path, origin), speeds.length() > 0, solver->horizon(), solver->inputs(), traits,
             o.steer_limit),
        states(static_cast<std::size_t>(solver->horizon()) + 1) {
    solver->connect(model->evaluator());
    if (!model->has_dynamics()) return;
    detour = std::make_unique<Detour>(limited_path(relative(path, origin), o, traits), speeds.length() > 0,
                                      traits.body);
    set_friction(traits.friction);
    model->set_top_speed(o.max_speed);
    if (traits.seeks_lap_time) field.set_curvatures(speeds.curvatures(), speeds.length() > 0);
  }

  /// Plans for ground of this friction. The path's speeds follow in steps of 2 %.
  void set_friction(double friction) noexcept {
    model->set_friction(friction);
    if (std::abs(friction - path_friction) <= 0.02 * path_friction) return;
    path_friction = friction;
    speeds.update(driving_limits(traits, friction));
    field.set_speeds(speeds.speeds());
  }

  void forget_car() noexcept {
    car.reset();
    path_friction = 0;
    if (model->has_dynamics()) set_friction(traits.friction);
  }

  /// Where plans begin: the car when the next command takes effect.
  VehicleStart start_of_plan(const PlannerInput& input) noexcept {
    const Odometry& odometry = input.odometry;
    if (!model->has_dynamics()) return history.lead_ahead({odometry.pose, odometry.speed, history.steer()});
    car.update(*model, {odometry.pose, odometry.speed, odometry.covariance, input.imu});
    const VehicleStart start = car.state().ahead(*model);
    speed_ahead = car.state().speed_ahead(*model);
    set_friction(car.cautious_friction());
    return start;
  }
  /// Where plans take the scan from. A pose with a covariance is an estimate, and plans begin where the
  /// filter says. From elsewhere, plans would keep a wrong distance from walls.
  maps::Pose pose_of_scan(const Odometry& odometry) const noexcept {
    const bool estimated = odometry.covariance[0][0] > 0;
    return estimated && model->has_dynamics() ? car.state().now().pose : odometry.pose;
  }
  double steer_estimate() const noexcept {
    return model->has_dynamics() ? car.state().now().steer : history.steer();
  }
  /// Checks, records and sends the command, with the steering gain of the car where that is known.
  void send(const Odometry& odometry) noexcept {
    output.corrections = check_command(output.command, limits(odometry), steer_estimate());
    history.send(observed_steer(output.command));
    if (model->has_dynamics()) output.command = car.send(output.command, options.steer_limit);
  }

  /// Without a plan: keeps the wheels' angle and stops.
  void stop(PlannerStatus status) noexcept {
    brakes = true;
    output.status = status;
    output.command = {steer_estimate(), 0};
    output.inputs = {};
    output.predicted = {};
    output.solve = nullptr;
    output.state_cost = output.collision_cost = 0;
  }

  void plan(PlannerInput input) noexcept {
    Odometry& odometry = input.odometry;
    odometry.pose.x -= origin.x;
    odometry.pose.y -= origin.y;
    const VehicleStart start = start_of_plan(input);
    const bool jumps = traits.unlimited_acceleration || model->has_dynamics();
    const double furthest =
        std::max(std::abs(odometry.speed), 1.0) + (jumps ? 0 : traits.max_acceleration * horizon_time());
    field.update({start.pose.x, start.pose.y}, 1 + furthest * horizon_time(), jumps ? time_in_view() : 0);
    obstacles.charge_time_behind(field, origin, start.pose);
    const maps::ReferenceCell here = field.at(start.pose.x, start.pose.y);
    if (traits.seeks_lap_time && options.sight_deceleration > 0) {
      seen = sight.look(input.scan, pose_of_scan(odometry), field.nearest());
      obstacles.add(sight.unknown());
      model->set_top_speed(std::min(sight.stopping_speed(seen.way), options.max_speed));
    }
    GridView<4> followed = field.view();
    if (model->has_dynamics() && options.back_up) followed = recover(odometry, start.pose);
    if (traits.follows_path && options.stop_when_blocked &&
        here.distance >= field.options().outside.distance) {
      return stop(PlannerStatus::off_course);
    }
    model->set_maps(obstacles.seen_from(pose_of_scan(odometry), followed, origin));
    model->set_start(start, traits.follows_path ? here.speed : traits.reference_speed);
    has_maps = true;
    choice.sees(obstacles.clearance_map().view(), obstacles.others(origin));
    SolveRequest request{.elapsed = options.control_period};
    if (options.deadline > 0) request.deadline = options.deadline;
    const SolveResult& result = solver->solve(model->evaluator(), request);
    output.solve = &result;
    output.status =
        result.status == Status::degenerate ? PlannerStatus::solver_degenerate : PlannerStatus::ok;
    PredictedCost cost = choice.predict(*model, result.inputs, states);
    std::span<const float> sent = result.inputs;
    if (options.verify_plan && model->has_dynamics() && !recovery.reversing()) {
      ways.draw(start, field.nearest(), speeds.speeds(), path_friction);
      SequenceChoice::Choice best{sent, cost};
      if (traits.seeks_lap_time) best = choice.kept(*model, best, options.control_period, states);
      const auto slower = choice.slower(*model, best, states);
      const auto chosen = choice.better(*model, slower, ways.cheapest(model->evaluator()), states);
      if (cost.collided && !chosen.cost.collided) output.status = PlannerStatus::fallback_plan;
      cost = chosen.cost;
      sent = chosen.inputs;
    }
    if (options.verify_plan && cost.collided) {
      const auto chosen = choice.choose(*model, result, {sent, cost}, recovery.reversing(), states);
      if (!chosen.cost.collided) output.status = PlannerStatus::fallback_plan;
      cost = chosen.cost;
      sent = chosen.inputs;
    }
    output.inputs = sent;
    output.inputs_per_step = model->inputs();
    output.predicted = states;
    output.state_cost = cost.state;
    output.collision_cost = cost.collision;
    output.command = model->has_dynamics() ? model->command(sent, speed_ahead, options.control_period)
                                           : Command{static_cast<double>(sent[0]), command_speed(here.speed)};
    planned_steer = without_turns(output.command.steer);
    output.command.steer = std::clamp(planned_steer, -options.steer_limit, options.steer_limit);
    if (model->has_dynamics()) {
      choice.sent(sent);
      if (cost.collided || recovery.reversing()) output.status = PlannerStatus::blocked;
    } else if (options.verify_plan && options.stop_when_blocked) {
      slow_down(cost, odometry.speed);
    }
    shift(states, origin);
  }

  /// Sets whether plans reverse and how urgent they are. Returns the field to follow: of path or detour.
  GridView<4> recover(const Odometry& odometry, const maps::Pose& start) noexcept {
    const int nearest = field.nearest();
    recovery.update(speeds.arc(nearest), speeds.length(), odometry.speed,
                    speeds.speeds()[static_cast<std::size_t>(nearest)], options.control_period,
                    obstacles.one_drives_ahead(odometry.pose, origin));
    detour->note(recovery, odometry.pose);
    model->set_reverse(recovery.reversing() ? Recovery::speed : 0);
    model->set_margin_share(recovery.margin_share());
    if (recovery.tries_again() && detour->search(obstacles.clearance_map(), odometry.pose, nearest)) {
      model->set_urgency(Urgency::detour);
      return detour->field_around({start.x, start.y}).view();
    }
    const bool passes = (recovery.leaving() || seen.obstacle < PathInSight::all) && !recovery.reversing();
    model->set_urgency(passes ? Urgency::passing : Urgency::usual);
    return field.view();
  }

  /// Brakes where every plan collides. Where the start itself collides, braking does not help: the car
  /// follows the best plan, slowly once it is slow, and if it stays where it is it reverses.
  void slow_down(const PredictedCost& cost, double speed) noexcept {
    constexpr double creep = 0.5;  // m/s
    const bool too_near = model->start_collides();
    if (options.back_up && back_up.update(!cost.collided && !too_near, speed, options.control_period)) {
      output.command = {0, -BackUp::speed};
    } else if (too_near && speed < 2 * creep) {
      output.command.speed = std::min(output.command.speed, creep);
    } else if (cost.collided && !too_near) {
      brakes = true;
      output.command.speed = std::max(0.0, speed - 2 * traits.max_deceleration * options.control_period);
    }
    if (cost.collided) output.status = PlannerStatus::blocked;
  }

  /// m/s, of commands.
  double slowest() const noexcept {
    return !model->has_dynamics() ? -BackUp::speed : recovery.reversing() ? -1.5 * Recovery::speed : 0;
  }
  CommandLimits limits(const Odometry& odometry) const noexcept {
    const double now = std::isfinite(odometry.speed) ? std::max(odometry.speed, 0.0) : 0;
    return {options.steer_limit, brakes ? std::min(now, options.max_speed) : options.max_speed, slowest()};
  }

  /// The paper's program sends the planned angle less whole turns, as a float32.
  double without_turns(double angle) const noexcept {
    if (!options.published.wrap_steer) return angle;
    return static_cast<double>(static_cast<float>(std::atan2(std::sin(angle), std::cos(angle))));
  }

  /// The angle that the observer follows: that of the command. The paper's program does not limit it; if only
  /// the limit made the difference, it is that of the plan.
  double observed_steer(const Command& command) const noexcept {
    if (!options.published.wrap_steer || output.inputs.empty()) return command.steer;
    const double limited_steer = std::clamp(planned_steer, -options.steer_limit, options.steer_limit);
    return command.steer == limited_steer ? planned_steer : command.steer;
  }

  double horizon_time() const noexcept { return traits.time_step * solver->horizon(); }
  /// s, of a plan and of stopping after it.
  double time_in_view() const noexcept {
    if (!model->has_dynamics()) return horizon_time();
    return horizon_time() + stopping_time * traits.friction / path_friction;
  }

  /// The speed to command where that of the path is `here`.
  double command_speed(double here) const noexcept {
    if (!traits.follows_path) return std::min(traits.reference_speed, options.max_speed);
    const bool planned = traits.plans_speed;
    if (options.speed_lookahead <= 0 && !planned) return here;
    const double last = static_cast<double>(states.size() - 1),
                 step = std::clamp(options.speed_lookahead / traits.time_step, planned ? 1.0 : 0.0, last);
    const PredictedState& ahead = states[static_cast<std::size_t>(std::round(step))];
    if (planned) return ahead.speed;
    const maps::ReferenceCell cell = field.at(ahead.pose.x, ahead.pose.y);
    return cell.distance < field.options().outside.distance ? cell.speed : here;
  }
};

Planner::Planner(const PlannerOptions& options, std::unique_ptr<VehicleModel> model,
                 std::span<const maps::ReferencePoint> path, std::unique_ptr<Solver> solver) {
  check_parts(options, model.get(), path, solver.get());
  implementation_ = std::make_unique<Implementation>(options, std::move(model), path, std::move(solver));
}

Planner::~Planner() = default;
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

const PlannerOutput& Planner::update(const PlannerInput& input) noexcept {
  const auto begin = std::chrono::steady_clock::now();
  Implementation& p = *implementation_;
  PlannerOutput& out = p.output;
  const bool placed = plausible(input.odometry);
  out.scan = p.obstacles.update(input, placed);
  out.steer_estimate = p.steer_estimate();
  p.brakes = false;
  const bool blind = !out.scan.accepted || out.scan.invalid == out.scan.beams;
  const bool seen_free = out.scan.accepted && input.scan.ranges.size() > 1 && !blind;
  if (!placed) {
    p.stop(PlannerStatus::bad_odometry);
  } else if (!seen_free) {
    p.stop(PlannerStatus::bad_scan);
  } else {
    p.plan(input);
  }
  if (p.model->has_dynamics()) p.car.publish(out);
  p.send(input.odometry);
  check_output(out, p.limits(input.odometry), out.steer_estimate);
  out.tick_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

void Planner::reset(std::uint64_t seed) noexcept {
  implementation_->history.reset();
  implementation_->forget_car();
  implementation_->back_up.reset();
  implementation_->recovery.reset();
  implementation_->choice.reset();
  implementation_->solver->reset(seed);
  implementation_->obstacles.reset();
  implementation_->has_maps = false;
  implementation_->output = {};
}

PredictedCost Planner::predict(std::span<const float> inputs,
                               std::span<PredictedState> states) const noexcept {
  if (!implementation_->has_maps) return {};
  const PredictedCost cost = implementation_->model->predict(inputs, states);
  const auto steps = inputs.size() / static_cast<std::size_t>(implementation_->model->inputs());
  detail::shift(states.first(steps + 1), implementation_->origin);
  return cost;
}

const Solver& Planner::solver() const noexcept {
  return *implementation_->solver;
}
const maps::LocalCostMap& Planner::cost_map() const noexcept {
  return implementation_->obstacles.cost_map();
}

}  // namespace slalom::vehicle
