#include <algorithm>
#include <cmath>
#include <optional>

#include "slalom/maps/recovery.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/estimation/parameter_estimator.hpp"
#include "vehicle/estimation/state_observer.hpp"
#include "vehicle/planner/detour.hpp"
#include "vehicle/planner/feasible_speeds.hpp"
#include "vehicle/planner/manoeuvre.hpp"
#include "vehicle/planner/map_options.hpp"
#include "vehicle/planner/passage.hpp"
#include "vehicle/planner/planner_base.hpp"
#include "vehicle/planner/sight.hpp"
#include "vehicle/planner/ways_around.hpp"

namespace slalom::vehicle::detail {
namespace {

/// Estimates state and parameters of a car whose tyres slip. States and plans hold the angle of the wheels. A
/// command is this angle less the car's steering offset, divided by its steering gain.
class CarEstimator {
 public:
  CarEstimator(const PlannerOptions& options, const DynamicVehicleModel& model);

  void reset() noexcept;

  /// Takes the measurements one control period after the last ones. Predictions use the mean friction.
  void update(const DynamicVehicleModel& model, const ObserverInput& input) noexcept;

  /// Returns the command for this angle of the wheels, rounded to the resolution of the steering.
  Command command(const Command& wheels, double steer_limit) const noexcept;

  /// Records the command that the car obeys from now on.
  void send(const Command& command) noexcept;

  /// Returns the estimate of car and ground, or the given values if nothing is learned.
  ParameterEstimate parameters() const noexcept;
  const StateObserver& state() const noexcept { return observer_; }

 private:
  bool identify_;
  double latency_, steer_resolution_, friction_;
  StateObserver observer_;
  ParameterEstimator parameters_;
};

CarEstimator::CarEstimator(const PlannerOptions& options, const DynamicVehicleModel& model)
    : identify_(options.estimation.identify),
      latency_(options.latency),
      steer_resolution_(options.steer_resolution),
      friction_(model.traits().tyres.friction),
      observer_(options.estimation, options.control_period, options.latency, model.traits().dead_time),
      parameters_(model.dynamics(), options.estimation, model.traits().tyres.friction,
                  options.latency + model.traits().dead_time, options.control_period) {}

void CarEstimator::reset() noexcept {
  observer_.reset();
  parameters_.reset();
}

void CarEstimator::update(const DynamicVehicleModel& model, const ObserverInput& input) noexcept {
  ObserverInput checked = input;
  if (input.imu && !plausible(*input.imu)) checked.imu.reset();
  observer_.update(model, checked, parameters().friction);
  if (!identify_) return;
  const VehicleStart& car = observer_.now();
  parameters_.update({input.pose, car.speed, car.yaw_rate, car.slip});
  const double start = parameters_.start_delay() - model.traits().dead_time;
  observer_.set_delays(std::max(latency_, start), parameters_.estimate().delay);
}

Command CarEstimator::command(const Command& wheels, double steer_limit) const noexcept {
  Command command = wheels;
  const ParameterEstimate car = parameters();
  command.steer =
      std::clamp((wheels.steer - car.steering_offset) / car.steering_gain, -steer_limit, steer_limit);
  if (const double step = steer_resolution_; step > 0) {
    const double most = std::floor(steer_limit / step);
    command.steer = step * std::clamp(std::round(command.steer / step), -most, most);
  }
  return command;
}

void CarEstimator::send(const Command& command) noexcept {
  const ParameterEstimate car = parameters();
  observer_.send({command.steer * car.steering_gain + car.steering_offset, command.speed});
  parameters_.send(command);
}

ParameterEstimate CarEstimator::parameters() const noexcept {
  if (identify_) return parameters_.estimate();
  return {.friction = friction_, .cautious_friction = friction_};
}

/// The planner of a car whose tyres slip. It plans steering and acceleration with the car's dynamics, and
/// learns friction and steering while it drives.
class DynamicPlanner final : public PlannerBase {
 public:
  explicit DynamicPlanner(PlannerParts& parts)
      : PlannerBase(parts),
        path_(parts.path),
        car_(options_, this->model()),
        speeds_(limited_path(parts.path, options_, traits_), options_.grip_shares.values()),
        sight_(parts.path, speeds_.length() > 0, reach_, options_, traits_.body),
        passage_(parts.path, speeds_.length() > 0, traits_.body),
        recovery_(maps::RecoveryLengths::of(length_of(traits_.body))),
        detour_(limited_path(parts.path, options_, traits_), speeds_.length() > 0, traits_.body),
        manoeuvre_(parts.path, speeds_.length() > 0, traits_.body, traits_.wheelbase, options_.steer_limit),
        ways_(parts.path, speeds_.length() > 0, solver_->horizon(), solver_->inputs(), traits_,
              options_.steer_limit) {
    set_friction(traits_.tyres.friction);
    if (traits_.tyres.seeks_lap_time) field_.set_curvatures(speeds_.curvatures(), speeds_.length() > 0);
  }
  std::unique_ptr<PlannerBase> clone() const override { return std::make_unique<DynamicPlanner>(*this); }

 private:
  void plan(const PlannerInput& input) noexcept override {
    // Estimate: where the car is when the next command takes effect, and the friction of the ground.
    const Odometry& odometry = input.odometry;
    car_.update(model(), {odometry.pose, odometry.speed, odometry.covariance, input.imu});
    const VehicleStart start = car_.state().ahead(model());
    const double speed_ahead = car_.state().speed_ahead(model());
    set_friction(car_.parameters().cautious_friction);

    // Maps: the path and the obstacles around it, as far as the car can get and stop.
    const maps::Pose scan_pose = pose_of_scan(odometry);
    const double fastest = std::max(std::abs(odometry.speed), 1.0);
    field_.update(start.pose, 1 + fastest * horizon_time(), time_in_view());
    obstacles_.charge_time_behind(field_, origin_, start.pose);
    const maps::ReferenceCell here = field_.at(start.pose.x, start.pose.y);
    conditions_.top_speed = top_speed_;
    conditions_.margin_share = conditions_.soft_share = 1;
    if (traits_.tyres.seeks_lap_time && options_.sight_deceleration > 0) look_ahead(input.scan, scan_pose);
    if (options_.back_up && traits_.obstacles.map == ObstacleMap::clearance)
      fit_margins(scan_pose, 1 + fastest * horizon_time());
    if (options_.back_up) recover(odometry, start.pose);
    if (options_.back_up && manoeuvres(input, scan_pose)) return;
    if (must_stop(here)) return stop(PlannerStatus::off_course);
    model().set_conditions(conditions_);
    begin_rollouts(scan_pose, start, here.speed);
    choice_.sees(obstacles_.seen_from(scan_pose, followed(), origin_));

    // Solve.
    const SolveResult& result = solve();

    // Choose: the solution, the last plan, a slower sequence or a way around; a stop if all collide.
    choice_.begin(model(), result);
    const SequenceChoice::Choice& chosen = choice_.best();
    if (options_.verify_plan) choose(start);

    // Command.
    publish();
    output_.command = model().command(chosen.inputs, speed_ahead, options_.control_period);
    output_.command.steer = std::clamp(output_.command.steer, -options_.steer_limit, options_.steer_limit);
    choice_.sent(chosen.inputs);
    if (chosen.cost.collided || recovery_.reverses()) output_.status = PlannerStatus::blocked;
  }

  /// Sets the friction of the ground for plans. The speeds of the path change only if it changes by more than
  /// 2 %, or with the top speed.
  void set_friction(double friction) noexcept {
    conditions_.friction = friction;
    const bool same = std::abs(friction - path_friction_) <= 0.02 * path_friction_;
    if (same && top_speed_ == path_top_speed_) return;
    if (!same) path_friction_ = friction;
    DrivingLimits limits = driving_limits(traits_, path_friction_);
    limits.top_speed = path_top_speed_ = top_speed_;
    speeds_.update(limits);
    field_.set_speeds(speeds_.speeds());
  }

  /// Returns the pose of the scan. A pose with a covariance is an estimate; then plans begin at the pose of
  /// the filter. The scan must have the same pose, or plans would keep a wrong distance from walls.
  maps::Pose pose_of_scan(const Odometry& odometry) const noexcept {
    return odometry.covariance[0][0] > 0 ? car_.state().now().pose : odometry.pose;
  }

  /// The time of a plan and of stopping after it, s.
  double time_in_view() const noexcept {
    return horizon_time() + stopping_time_ * traits_.tyres.friction / path_friction_;
  }

  /// Limits the speed, so that the car can stop within the part of the path that is in sight.
  void look_ahead(const maps::LaserScanView& scan, const maps::Pose& scan_pose) noexcept {
    seen_ = sight_.look(scan, scan_pose, field_.nearest());
    obstacles_.add(sight_.unknown());
    conditions_.top_speed = std::min(conditions_.top_speed, sight_.stopping_speed(seen_.way));
  }

  /// Lets plans keep no wider margins than the narrowest place of the next `reach` m has, and pass it slowly.
  /// A moving car close ahead is no narrow place: the car keeps its margins and may overtake.
  void fit_margins(const maps::Pose& scan_pose, double reach) noexcept {
    if (obstacles_.one_drives_ahead(scan_pose, origin_)) return;
    const WidestWay way = passage_.search(obstacles_.clearance_map(), scan_pose, field_.nearest(), reach);
    conditions_.margin_share = way.margin_share;
    conditions_.soft_share = way.soft_share;
    conditions_.top_speed = std::min(conditions_.top_speed, way.top_speed);
  }

  /// Decides whether plans reverse, how urgent they are, and whether they follow a detour.
  void recover(const Odometry& odometry, const maps::Pose& start) noexcept {
    const int nearest = field_.nearest();
    const double end = speeds_.arc(static_cast<int>(path_.size()) - 1), here = speeds_.arc(nearest);
    const bool at_end = speeds_.length() == 0 && end - here < 2 * recovery_.lengths().progress;
    if (at_end) recovery_.watch_from(here);
    recovery_.update({.arc = here,
                      .speed = odometry.speed,
                      .free_speed = speeds_.speeds()[static_cast<std::size_t>(nearest)],
                      .closed_length = speeds_.length(),
                      .waits = obstacles_.one_drives_ahead(odometry.pose, origin_)},
                     options_.control_period);
    detour_.note(recovery_, odometry.pose);
    conditions_.reverse = recovery_.reverses() ? recovery_.lengths().reverse : 0;
    conditions_.margin_share = std::min(conditions_.margin_share, recovery_.margin_share());
    on_detour_ = recovery_.retries() && detour_.search(obstacles_.clearance_map(), odometry.pose, nearest);
    if (on_detour_) {
      detour_.update_field(start);
      conditions_.urgency = Urgency::detour;
    } else {
      const bool passes = (recovery_.leaving() || seen_.obstacle < PathInSight::all) && !recovery_.reverses();
      conditions_.urgency = passes ? Urgency::passing : Urgency::usual;
    }
  }

  /// Drives a manoeuvre where the car stands without a way on, or is turned away from the path. Returns
  /// whether the command is that of a manoeuvre.
  bool manoeuvres(const PlannerInput& input, const maps::Pose& pose) noexcept {
    const maps::RecoveryLengths& lengths = recovery_.lengths();
    const int nearest = field_.nearest();
    const double speed = input.odometry.speed, yaw = path_[static_cast<std::size_t>(nearest)].yaw;
    const bool turned = std::abs(maps::wrap_angle(pose.yaw - yaw)) > most_turned;
    const bool stands = std::abs(speed) < lengths.standing;
    const bool was_active = recovery_.state() == maps::DriveState::manoeuvring;
    const bool begins = (recovery_.reverses() && recovery_.begins()) || (turned && stands);
    if (traits_.obstacles.map != ObstacleMap::clearance || (!was_active && !begins)) return false;
    const maps::ClearanceMap& obstacles = obstacles_.clearance_map();
    const auto find = [&] {
      return manoeuvre_.search(obstacles, pose, nearest, turned ? -1e3 : 3 * lengths.progress,
                               std::abs(input.scan.angle_min));
    };
    const auto follow = [&] {
      return manoeuvre_.follow(obstacles, pose, speed, steer_estimate(), options_.control_period);
    };
    if (!was_active && !find()) return false;
    std::optional<Command> command = follow();
    if (!command && was_active && manoeuvre_.active()) {  // it has left the way, or an obstacle is on it
      if (!stands) {
        command = Command{steer_estimate(), 0};
      } else if (find()) {
        command = follow();
      }
    }
    if (!command) {  // one that cannot begin leaves the car to the recovery
      manoeuvre_.cancel();
      if (was_active) recovery_.end_manoeuvre(speeds_.arc(nearest));
      return false;
    }
    if (!was_active) recovery_.begin_manoeuvre();
    stop(manoeuvre_.reverses() ? PlannerStatus::blocked : PlannerStatus::fallback_plan);
    brakes_ = false;
    output_.command = *command;
    return true;
  }

  /// Replaces the solution by a better sequence, if there is one.
  void choose(const VehicleStart& start) noexcept {
    const SequenceChoice::Choice& chosen = choice_.best();
    const bool solution_collides = chosen.cost.collided;
    if (!recovery_.reverses()) {
      ways_.draw(start, field_.nearest(), speeds_.speeds(), path_friction_);
      if (traits_.tyres.seeks_lap_time) choice_.consider_last(options_.control_period);
      choice_.consider_slower();
      choice_.consider(ways_.cheapest(model_->evaluator()));
    }
    if (chosen.cost.collided) choice_.consider_samples();
    if (chosen.cost.collided) choice_.stop(recovery_.reverses());
    if (solution_collides && !chosen.cost.collided) output_.status = PlannerStatus::fallback_plan;
  }

  /// Completes the output: its estimates, and the command that turns the wheels to the planned angle.
  void send(const std::optional<Command>& obeyed) noexcept override {
    const VehicleStart& now = car_.state().now();
    output_.speed_estimate = now.speed;
    output_.yaw_rate_estimate = now.yaw_rate;
    output_.slip_estimate = now.slip;
    output_.parameters = car_.parameters();
    output_.command = car_.command(output_.command, options_.steer_limit);
    car_.send(obeyed.value_or(output_.command));
  }
  void forget() noexcept override {
    car_.reset();
    path_friction_ = 0;
    set_friction(traits_.tyres.friction);
    recovery_.reset();
    manoeuvre_.cancel();
  }
  double steer_estimate() const noexcept override { return car_.state().now().steer; }
  double slowest() const noexcept override {
    const bool drives_back = recovery_.reverses() || recovery_.state() == maps::DriveState::manoeuvring;
    return drives_back ? -1.5 * recovery_.lengths().reverse : 0;
  }
  GridView<4> followed() const noexcept override {
    return on_detour_ ? detour_.field().view() : field_.view();
  }

  DynamicVehicleModel& model() noexcept { return static_cast<DynamicVehicleModel&>(*model_); }

  static constexpr double most_turned = 1.8;  ///< rad from the path, beyond which the car turns first

  std::vector<maps::ReferencePoint> path_;
  CarEstimator car_;
  FeasibleSpeeds speeds_;
  Sight sight_;
  Passage passage_;
  PathInSight seen_;  ///< set only with `sight_deceleration`
  maps::Recovery recovery_;
  Detour detour_;
  Manoeuvre manoeuvre_;
  WaysAround ways_;
  DrivingConditions conditions_;
  double path_friction_ = 0;   ///< friction for which the path's speeds were computed
  double path_top_speed_ = 0;  ///< m/s, the same
  bool on_detour_ = false;     ///< plans follow the detour, not the path
};

}  // namespace

std::unique_ptr<PlannerBase> make_dynamic_planner(PlannerParts& parts) {
  return std::make_unique<DynamicPlanner>(parts);
}

}  // namespace slalom::vehicle::detail
