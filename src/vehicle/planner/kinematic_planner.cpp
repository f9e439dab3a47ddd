#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/recovery.hpp"
#include "vehicle/planner/command_history.hpp"
#include "vehicle/planner/map_options.hpp"
#include "vehicle/planner/planner_base.hpp"

namespace slalom::vehicle::detail {
namespace {

/// The planner of a car whose tyres do not slip. It plans the steering. The speed is that of the path, or
/// that of the plan if the acceleration is an input.
class KinematicPlanner final : public PlannerBase {
 public:
  explicit KinematicPlanner(PlannerParts& parts)
      : PlannerBase(parts),
        history_(options_.control_period, options_.latency + traits_.dead_time,
                 options_.observer_time_constant, traits_.wheelbase),
        recovery_(maps::RecoveryLengths::of(traits_.body.front + traits_.body.rear)) {
    for (const maps::ReferencePoint& point : limited_path(parts.path, options_, traits_))
      path_speeds_.push_back(point.speed);
    speeds_ = path_speeds_;
  }
  std::unique_ptr<PlannerBase> clone() const override { return std::make_unique<KinematicPlanner>(*this); }

 private:
  void plan(const PlannerInput& input) noexcept override {
    // Estimate: where the car is when the next command takes effect.
    const Odometry& odometry = input.odometry;
    const VehicleStart start = history_.lead_ahead({odometry.pose, odometry.speed, history_.steer()});

    // Maps: the path and the obstacles around it, as far as the car can get.
    const bool jumps = traits_.speed.unlimited_acceleration;
    const double gain = jumps ? 0 : traits_.max_acceleration * horizon_time();
    const double fastest = std::max(std::abs(odometry.speed), 1.0) + gain;
    if (std::exchange(field_top_speed_, top_speed_) != top_speed_) {
      for (std::size_t i = 0; i < speeds_.size(); ++i) speeds_[i] = std::min(path_speeds_[i], top_speed_);
      field_.set_speeds(speeds_);
    }
    field_.update(start.pose, 1 + fastest * horizon_time(), jumps ? horizon_time() : 0);
    const maps::ReferenceCell here = field_.at(start.pose.x, start.pose.y);
    if (must_stop(here)) return stop(PlannerStatus::off_course);
    begin_rollouts(odometry.pose, start, here.speed);
    if (options_.verify_plan) choice_.sees(obstacles_.seen_from(odometry.pose, followed(), origin_));

    // Solve.
    const SolveResult& result = solve();

    // Choose: another sequence if the solution collides.
    choice_.begin(*model_, result);
    const SequenceChoice::Choice& chosen = choice_.best();
    if (options_.verify_plan && chosen.cost.collided) {
      choice_.consider_samples();
      if (!chosen.cost.collided) output_.status = PlannerStatus::fallback_plan;
    }

    // Command.
    publish();
    planned_steer_ = without_turns(static_cast<double>(chosen.inputs[0]));
    output_.command = {limited(planned_steer_), command_speed(here.speed)};
    if (options_.verify_plan && options_.stop_when_blocked) slow_down(chosen.cost, odometry.speed);
  }

  /// Returns the speed to command; `here` is the speed of the path.
  double command_speed(double here) const noexcept {
    if (!traits_.speed.follows_path) return std::min(traits_.speed.reference, top_speed_);
    const bool planned = traits_.speed.planned;
    if (options_.speed_lookahead <= 0 && !planned) return here;
    const std::span<const PredictedState> states = choice_.states();
    const double last = static_cast<double>(states.size() - 1),
                 step = std::clamp(options_.speed_lookahead / traits_.time_step, planned ? 1.0 : 0.0, last);
    const PredictedState& ahead = states[saturate_cast<std::size_t>(std::round(step))];
    if (planned) return ahead.speed;
    const maps::ReferenceCell cell = field_.at(ahead.pose.x, ahead.pose.y);
    return cell.distance < field_.options().outside.distance ? cell.speed : here;
  }

  /// Brakes if every plan collides. If the start itself collides, braking does not help: then the car follows
  /// the best plan, and creeps once it is slow. If it does not get away, it reverses.
  void slow_down(const PredictedCost& cost, double speed) noexcept {
    constexpr double creep = 0.5;  // m/s
    const bool too_near = model_->start_collides();
    const bool is_free = !cost.collided && !too_near;
    driven_ += speed * options_.control_period;
    recovery_.update({.arc = driven_, .speed = speed, .waits = is_free, .is_free = is_free},
                     options_.control_period);
    if (options_.back_up && recovery_.reverses()) {
      output_.command = {0, -recovery_.lengths().reverse};
    } else if (too_near && speed < 2 * creep) {
      output_.command.speed = std::min(output_.command.speed, creep);
    } else if (cost.collided && !too_near) {
      brakes_ = true;
      output_.command.speed = std::max(0.0, speed - 2 * traits_.max_deceleration * options_.control_period);
    }
    if (cost.collided) output_.status = PlannerStatus::blocked;
  }

  /// Records the angle that the wheels turn to: that of the command. The observer of the paper's program
  /// (`wrap_steer`) follows the planned angle instead, which is not limited, unless another command is sent.
  void send(const std::optional<Command>& obeyed) noexcept override {
    const double sent = obeyed.value_or(output_.command).steer;
    const bool sends_plan = !obeyed && !output_.inputs.empty() && sent == limited(planned_steer_);
    history_.send(options_.published.wrap_steer && sends_plan ? planned_steer_ : sent);
  }
  void forget() noexcept override {
    history_.reset();
    recovery_.reset();
    driven_ = 0;
  }
  double steer_estimate() const noexcept override { return history_.steer(); }
  double slowest() const noexcept override { return -recovery_.lengths().reverse; }

  double limited(double steer) const noexcept {
    return std::clamp(steer, -options_.steer_limit, options_.steer_limit);
  }
  /// Removes whole turns from the planned angle and rounds it to float32, as the paper's program does.
  double without_turns(double angle) const noexcept {
    if (!options_.published.wrap_steer) return angle;
    return static_cast<double>(static_cast<float>(std::atan2(std::sin(angle), std::cos(angle))));
  }

  CommandHistory history_;
  maps::Recovery recovery_;
  std::vector<double> path_speeds_, speeds_;     ///< m/s, of the path, and within the top speed
  double field_top_speed_ = options_.max_speed;  ///< m/s, of `speeds_`
  double driven_ = 0;                            ///< m, forward less backward
  double planned_steer_ = 0;                     ///< rad, before it was limited
};

}  // namespace

std::unique_ptr<PlannerBase> make_kinematic_planner(PlannerParts& parts) {
  return std::make_unique<KinematicPlanner>(parts);
}

}  // namespace slalom::vehicle::detail
