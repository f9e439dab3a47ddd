#pragma once

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle {

namespace detail {

/// The functions that ProblemModel and DynamicProblemModel have in common.
template <VehicleProblem P, class Interface>
class ProblemModelBase : public Interface {
  using Evaluator = ProblemEvaluator<P>;
  using State = typename Evaluator::State;  ///< the problem's state in double

 public:
  /// A vehicle model of `problem`, whose rollouts use the instruction set `target`.
  explicit ProblemModelBase(P problem, simd::Target target = simd::active_target())
      : evaluator_(std::move(problem), target) {}

  int inputs() const noexcept override { return P::inputs; }
  /// The properties of the model.
  VehicleTraits traits() const noexcept override { return evaluator_.problem().traits(); }
  /// Sets the maps that rollouts look up.
  void set_maps(const VehicleMaps& maps) noexcept override {
    maps_ = maps;
    evaluator_.problem().set_maps(maps_.relative_to(origin_));
  }

  void set_start(const VehicleStart& start, double reference_speed) noexcept override {
    origin_ = {start.pose.x, start.pose.y};
    evaluator_.problem().set_maps(maps_.relative_to(origin_));
    VehicleStart local = start;
    local.pose = {0, 0, start.pose.yaw};
    start_ = evaluator_.problem().start(local, reference_speed);
    evaluator_.set_state(start_);
  }

  const BatchEvaluator& evaluator() const noexcept override { return evaluator_; }

  bool start_collides() const noexcept override {
    const P& problem = evaluator_.problem();
    const auto seen = slalom::detail::look_up<P, double>(problem, start_);
    return slalom::detail::stage_cost<P, double>(problem, start_, seen, Input<double, P::inputs>{}, 0)
        .collided;
  }

  PredictedCost predict(std::span<const float> inputs,
                        std::span<PredictedState> states) const noexcept override {
    const P& problem = evaluator_.problem();
    PredictedCost total;
    State s = start_;
    bool was_free = false;
    const std::size_t steps = inputs.size() / P::inputs;
    for (std::size_t k = 0; k <= steps; ++k) {
      states[k] = problem.predicted(s);
      states[k].pose.x += origin_.x;
      states[k].pose.y += origin_.y;
      const auto seen = slalom::detail::look_up<P, double>(problem, s);
      const bool last = k == steps;
      Input<double, P::inputs> u{};
      for (std::size_t i = 0; !last && i < P::inputs; ++i)
        u.value[i] = static_cast<double>(inputs[k * P::inputs + i]);
      const int step = static_cast<int>(k);
      Cost<double> cost{};
      if (!last)
        cost = slalom::detail::stage_cost<P, double>(problem, s, seen, u, step);
      else if constexpr (!slalom::detail::LacksTerminalCost<P>)
        cost = slalom::detail::terminal_cost<P, double>(problem, s, seen);
      double collision = problem.collision_part(seen, last);
      if constexpr (requires { problem.others_part(s, step); }) collision += problem.others_part(s, step);
      total.state += cost.value - collision;
      total.distance += problem.distance_part(seen, last);
      total.collision += collision;
      total.collided |= cost.collided && was_free;
      was_free |= !cost.collided;
      states[k].cost = total;
      if (!last) s = slalom::detail::step<P, double>(problem, s, seen, u, step);
    }
    total.collided |= !was_free;
    return total;
  }

 protected:
  Evaluator evaluator_;  ///< rolls out the problem
  State start_{};        ///< start of rollouts, in the problem's frame

 private:
  VehicleMaps maps_;
  maps::Point origin_;  ///< origin of the problem's frame, in the map frame
};

}  // namespace detail

/// Any vehicle problem as a vehicle model. Maps, start and predicted poses are in the map frame. The problem
/// itself runs in a parallel frame that begins at the start's position, which is subtracted in double:
/// float32 rollouts are as exact at UTM coordinates (5e6 m) as near the origin.
///
///     Planner planner(options, std::make_unique<ProblemModel<MyProblem>>(MyProblem{}), path, solver);
template <VehicleProblem P>
class ProblemModel final : public detail::ProblemModelBase<P, VehicleModel> {
 public:
  using detail::ProblemModelBase<P, VehicleModel>::ProblemModelBase;

  std::unique_ptr<VehicleModel> clone() const override { return std::make_unique<ProblemModel>(*this); }
};

/// The same for the problem of a car whose tyres slip.
template <DynamicVehicleProblem P>
class DynamicProblemModel final : public detail::ProblemModelBase<P, DynamicVehicleModel> {
  using Base = detail::ProblemModelBase<P, DynamicVehicleModel>;
  using Base::evaluator_, Base::start_;

 public:
  using detail::ProblemModelBase<P, DynamicVehicleModel>::ProblemModelBase;

  std::unique_ptr<VehicleModel> clone() const override {
    return std::make_unique<DynamicProblemModel>(*this);
  }
  const SingleTrackDynamics& dynamics() const noexcept override {
    return evaluator_.problem().model().dynamics();
  }
  void set_conditions(const DrivingConditions& conditions) noexcept override {
    evaluator_.problem().set_conditions(conditions);
  }
  VehicleStart advance(const VehicleStart& start, const Command& command, double duration,
                       double friction) const noexcept override {
    return evaluator_.problem().model().advance(start, command, duration, friction);
  }
  Command command(std::span<const float> inputs, double speed, double period) const noexcept override {
    const P& problem = evaluator_.problem();
    const auto seen = slalom::detail::look_up<P, double>(problem, start_);
    const double steering = static_cast<double>(inputs[0]), wanted = static_cast<double>(inputs[1]);
    const double acceleration = problem.model().limited(start_, seen.speed, wanted);
    return {problem.model().steering(start_, steering),
            problem.model().commanded_speed(speed, acceleration, period)};
  }
};

}  // namespace slalom::vehicle
