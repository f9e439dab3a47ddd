#pragma once

#include <memory>
#include <utility>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle {

/// Any vehicle problem as a vehicle model.
///
///     Planner planner(options, std::make_unique<ProblemModel<MyProblem>>(MyProblem{}), path, solver);
template <VehicleProblem P>
class ProblemModel final : public VehicleModel {
  using State = typename ProblemEvaluator<P>::State;

 public:
  explicit ProblemModel(P problem, simd::Target target = simd::active_target())
      : evaluator_(std::move(problem), target) {}

  int inputs() const noexcept override { return P::inputs; }
  VehicleTraits traits() const noexcept override { return evaluator_.problem().traits(); }
  void set_maps(const VehicleMaps& maps) noexcept override { evaluator_.problem().set_maps(maps); }

  void set_start(const VehicleStart& start, double reference_speed) noexcept override {
    start_ = evaluator_.problem().start(start, reference_speed);
    evaluator_.set_state(start_);
  }

  const BatchEvaluator& evaluator() const noexcept override { return evaluator_; }

  bool start_collides() const noexcept override {
    const P& problem = evaluator_.problem();
    return problem.stage_cost(start_, problem.look_up(start_), Input<double, P::inputs>{}).collided;
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
      const auto seen = problem.look_up(s);
      const bool last = k == steps;
      Input<double, P::inputs> u{};
      for (std::size_t i = 0; !last && i < P::inputs; ++i)
        u.value[i] = static_cast<double>(inputs[k * P::inputs + i]);
      const Cost<double> cost = last ? problem.terminal_cost(s, seen) : problem.stage_cost(s, seen, u);
      const double collision = problem.collision_part(seen, last);
      total.state += cost.value - collision;
      total.distance += problem.distance_part(seen, last);
      total.collision += collision;
      total.collided |= cost.collided && was_free;
      was_free |= !cost.collided;
      if (!last) s = problem.step(s, seen, u, static_cast<int>(k));
    }
    total.collided |= !was_free;
    return total;
  }

 private:
  ProblemEvaluator<P> evaluator_;
  State start_{};
};

}  // namespace slalom::vehicle
