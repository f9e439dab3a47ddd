#pragma once

#include <span>
#include <vector>

#include "slalom/solvers/solver.hpp"
#include "slalom/vehicle/model/obstacle_cost.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle::detail {

/// Chooses the sequence to send. It begins with the solver's solution and considers others, one kind after
/// another. A sequence is better if it alone does not collide; if both or neither collide, the cheaper one.
class SequenceChoice {
 public:
  /// A sequence, valid until the next `begin`, and its cost.
  struct Choice {
    std::span<const float> inputs;
    PredictedCost cost;
  };

  /// Sequences have `horizon` steps of `inputs` inputs.
  SequenceChoice(int horizon, int inputs, const VehicleTraits& traits);

  /// Sets the maps with which predictions are checked, in the frame of the predictions. They are used until
  /// the next call; before the first one nothing is checked.
  void sees(const VehicleMaps& maps) noexcept;

  /// Predicts a sequence; all choices compare these predictions. A sequence also collides if the body,
  /// without its margin, meets a fixed obstacle between two states, after the first state in which it is
  /// free. If plans seek the shortest time and the body has a margin, only the body itself can collide with
  /// fixed obstacles in the states, too, and the margin has a cost instead. The reason is noise: near a wall,
  /// each scan decides anew whether a plan keeps the margin. A car that braked for the margin at the limit of
  /// grip would turn in and hit the wall that it would otherwise have passed.
  PredictedCost predict(const VehicleModel& model, std::span<const float> inputs,
                        std::span<PredictedState> states) const noexcept;

  /// Begins with the solution. Model and result are used until the next call.
  void begin(const VehicleModel& model, const SolveResult& result) noexcept;

  /// Considers one sequence, [step][input], unless it has another size. Returns whether it is now the best.
  bool consider(std::span<const float> inputs) noexcept;
  /// Considers the sequence sent last, moved forward by `elapsed` (s) with its last inputs held. A solution
  /// is a mean over few samples and may be worse than the last plan.
  void consider_last(double elapsed) noexcept;
  /// Considers sequences along the path of the best one at other speeds: some brake first for a few steps,
  /// one only accelerates. The solver alone would brake too late, since few samples brake for long; and it
  /// would not drive off, since samples around a car at rest stand still. For models whose tyres slip.
  void consider_slower() noexcept;
  /// Considers the nominal sequence, the guides and the best sample.
  void consider_samples() noexcept;

  /// Replaces the best sequence by a full stop, for when every sequence collides. The car brakes as hard as
  /// the tyres allow, with the steering of the solution, the sequence sent last, the nominal one or a guide.
  /// Takes the cheapest stop without a collision, or else the cheapest of all. If plans seek the shortest
  /// time with a margin, and the car drives forwards and does not collide yet, takes the sequence that does
  /// the least harm instead. For models whose tyres slip.
  void stop(bool reversing) noexcept;

  /// The best sequence so far.
  const Choice& best() const noexcept { return best_; }
  /// The horizon + 1 predicted states of the best sequence.
  std::span<PredictedState> states() noexcept { return states_; }
  std::span<const PredictedState> states() const noexcept { return states_; }

  /// Remembers the sequence that is sent.
  void sent(std::span<const float> inputs) noexcept;
  /// Forgets the sequence sent last.
  void reset() noexcept { has_previous_ = false; }

 private:
  void follow_slower(int braking_steps) noexcept;
  void set_acceleration(std::span<const float> steering, float acceleration) noexcept;
  template <class Use>
  void for_each_known(std::span<const float> last, Use&& use) const;
  void brake(float acceleration) noexcept;
  void least_harm() noexcept;
  double harm(std::span<const float> inputs) noexcept;
  bool collides(const PredictedCost& cost, std::span<const PredictedState> states) const noexcept;
  bool body_collides(std::span<const PredictedState> states) const noexcept;
  bool others_collide(std::span<const PredictedState> states) const noexcept;

  std::size_t inputs_;
  VehicleTraits traits_;
  float max_deceleration_;
  std::vector<float> candidate_, braking_, previous_, kept_, slower_;
  std::vector<PredictedState> states_, candidate_states_, path_;
  bool margin_is_cost_;  ///< plans seek the shortest time, and the body has a margin
  ObstacleCost body_;    ///< without margin
  maps::MovingObstaclesView others_;
  bool sees_ = false;
  bool has_previous_ = false;
  const VehicleModel* model_ = nullptr;
  const SolveResult* result_ = nullptr;
  Choice best_;
};

}  // namespace slalom::vehicle::detail
