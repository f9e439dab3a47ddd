#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slalom/solvers/solver.hpp"
#include "slalom/vehicle/model/obstacle_cost.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle::detail {

/// Chooses the sequence to send, which may be better than the solver's solution.
class SequenceChoice {
 public:
  /// A sequence, valid until the next choice, and its cost.
  struct Choice {
    std::span<const float> inputs;
    PredictedCost cost;
  };

  /// Sequences have `horizon` steps of `inputs` inputs.
  SequenceChoice(int horizon, int inputs, const VehicleTraits& traits);

  /// Sets the clearances (m, robot's frame) around the car and the moving obstacles (in the frame of
  /// predictions). Both are used until the next call.
  void sees(const GridView<1>& clearances, const maps::MovingObstaclesView& others) noexcept;

  /// Predicts a sequence; all choices compare these predictions. If plans seek the shortest time and the body
  /// has a margin, only the body itself can collide with fixed obstacles, and the margin has a cost instead.
  /// The reason is noise: near a wall, each scan decides anew whether a plan keeps the margin. A car that
  /// braked for the margin at the limit of grip would turn in and hit the wall that it would otherwise have
  /// passed.
  PredictedCost predict(const VehicleModel& model, std::span<const float> inputs,
                        std::vector<PredictedState>& states) const noexcept;

  /// Returns the cheapest of the solution and of sequences along its path at other speeds: some brake first
  /// for a few steps, one only accelerates. The solver alone would brake too late, since few samples brake
  /// for long; and it would not drive off, since samples around a car at rest stand still. For models whose
  /// tyres slip. `states` as in `cheapest`.
  Choice slower(const VehicleModel& model, const Choice& solution,
                std::vector<PredictedState>& states) noexcept;

  /// Returns the cheaper of the solution and the sequence sent last, moved forward by `elapsed` (s) with its
  /// last inputs held. A solution is a mean over few samples and may be worse than the last plan. Collisions
  /// count before costs. `states` as in `cheapest`.
  Choice kept(const VehicleModel& model, const Choice& solution, double elapsed,
              std::vector<PredictedState>& states) noexcept;

  /// Returns the cheaper of the solution and another sequence. Collisions count before costs. `states` as in
  /// `cheapest`.
  Choice better(const VehicleModel& model, const Choice& solution, std::span<const float> other,
                std::vector<PredictedState>& states) noexcept;

  /// Returns the cheapest of the solution, the nominal sequence, the guides and the best sample. Collisions
  /// count before costs. `states` must hold the prediction of the solution and is replaced by that of the
  /// choice.
  Choice cheapest(const VehicleModel& model, const SolveResult& result, const Choice& solution,
                  std::vector<PredictedState>& states) noexcept;

  /// Returns a full stop, for when every sequence collides. The car brakes as hard as the tyres allow and
  /// steers like the solution, the sequence sent last, the nominal one or a guide: like the cheapest one that
  /// does not collide, or else the cheapest of all. If plans seek the shortest time with a margin, returns
  /// the sequence that does the least harm instead (`least_harm`). For models whose tyres slip. `states` as
  /// in `cheapest`.
  Choice stop(const VehicleModel& model, const SolveResult& result, const Choice& solution, bool reversing,
              std::vector<PredictedState>& states) noexcept;

  /// Remembers the sequence that is sent.
  void sent(std::span<const float> inputs) noexcept;
  /// Forgets the sequence sent last.
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
  std::optional<ObstacleCost> body_;  ///< body without margin, if it has one and plans seek the shortest time
  maps::MovingObstaclesView others_;
  bool has_previous_ = false;
};

}  // namespace slalom::vehicle::detail
