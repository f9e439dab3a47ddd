#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slalom/solvers/solver.hpp"
#include "slalom/vehicle/model/obstacle_cost.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle::detail {

/// Chooses the sequence that is sent, where another one is better than the solution.
class SequenceChoice {
 public:
  /// A sequence, valid until the next choice, and its cost.
  struct Choice {
    std::span<const float> inputs;
    PredictedCost cost;
  };

  /// Sequences have `horizon` steps with so many inputs each, for a car with these traits.
  SequenceChoice(int horizon, int inputs, const VehicleTraits& traits);

  /// Sets the clearances (m, robot's frame) around the car, and the obstacles that move (in the frame of
  /// predictions), until the next call.
  void sees(const GridView<1>& clearances, const maps::MovingObstaclesView& others) noexcept;

  /// The prediction of a sequence, with which all choices compare. Where plans seek the shortest time and the
  /// body has a margin, it collides with fixed obstacles only where the body itself does: nearness has a cost
  /// instead. Scans are noisy, so at a wall that a plan passes closely each of them decides anew whether the
  /// margin is kept. A car that brakes for it at the limit of grip turns in, and hits the wall that it would
  /// have passed.
  PredictedCost predict(const VehicleModel& model, std::span<const float> inputs,
                        std::vector<PredictedState>& states) const noexcept;

  /// The cheapest of the solution and of sequences along its path at other speeds: slower ones, which brake
  /// first for some steps, and faster ones. Samples of the solver rarely brake for long, so it would brake
  /// too late; and around a solution that stands still no sample drives. For models whose tyres slip.
  /// `states` as in `cheapest`.
  Choice slower(const VehicleModel& model, const Choice& solution,
                std::vector<PredictedState>& states) noexcept;

  /// The cheaper of the solution and the sequence sent last, moved forward by `elapsed` (s), with its last
  /// inputs held. A solution is a mean over the few samples that count; if it is worse than the last plan,
  /// collisions first, nothing calls for a change. `states` as in `cheapest`.
  Choice kept(const VehicleModel& model, const Choice& solution, double elapsed,
              std::vector<PredictedState>& states) noexcept;

  /// The cheaper of the solution and another sequence, collisions first; `states` as in `cheapest`.
  Choice better(const VehicleModel& model, const Choice& solution, std::span<const float> other,
                std::vector<PredictedState>& states) noexcept;

  /// The cheapest of the solution, the nominal sequence, the guides and the best sample, collisions first.
  /// `states` holds the prediction of the solution, afterwards that of the choice.
  Choice cheapest(const VehicleModel& model, const SolveResult& result, const Choice& solution,
                  std::vector<PredictedState>& states) noexcept;

  /// A full stop where every sequence collides: along the solution, the sequence sent last, the nominal one
  /// or a guide, as hard as the tyres allow; the cheapest that does not collide, else the cheapest of all.
  /// Where plans seek the shortest time with a margin, the sequence that does least harm instead: see
  /// `least_harm`. For models whose tyres slip. `states` as in `cheapest`.
  Choice stop(const VehicleModel& model, const SolveResult& result, const Choice& solution, bool reversing,
              std::vector<PredictedState>& states) noexcept;

  /// Keeps the sequence that is sent.
  void sent(std::span<const float> inputs) noexcept;
  /// Forgets it.
  void reset() noexcept { has_previous_ = false; }

 private:
  void follow_slower(int braking_steps) noexcept;
  Choice brake(const VehicleModel& model, const SolveResult& result, const Choice& solution, bool reversing,
               std::vector<PredictedState>& states) noexcept;
  Choice least_harm(const VehicleModel& model, const SolveResult& result, const Choice& solution,
                    std::vector<PredictedState>& states) noexcept;
  double harm(const VehicleModel& model, std::span<const float> inputs) noexcept;
  bool body_collides(std::span<const PredictedState> states) const noexcept;
  bool others_collide(std::span<const PredictedState> states) const noexcept;

  std::size_t inputs_;
  VehicleTraits traits_;
  float max_deceleration_;
  std::vector<float> candidate_, braking_, previous_, kept_, slower_;
  std::vector<PredictedState> candidate_states_, path_;
  std::optional<ObstacleCost> body_;  ///< without its margin, if it has one and plans seek the shortest time
  maps::MovingObstaclesView others_;
  bool has_previous_ = false;
};

}  // namespace slalom::vehicle::detail
