#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "slalom/core/sequence_batch.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom::detail {

/// The choice at the end of a solve of `svg_mppi` in batches. Without errors of predictions, the means are
/// compared with the plan. Otherwise the plan, the last plan and the means are compared by their mean cost
/// over the present state and states near it.
class LastChoice {
 public:
  LastChoice(int horizon, int inputs, int means, int most_states)
      : sequences(horizon, inputs, means + 2),
        costs(sequences.stride()),
        collided(static_cast<std::size_t>(sequences.stride())),
        most_states_(most_states),
        last_plan_(static_cast<std::size_t>(sequences.rows())),
        present_(static_cast<std::size_t>(sequences.samples())),
        sums_(present_.size()) {}

  /// Begins a solve of so many rollouts with the last plan. Returns how many of them the choice needs.
  int begin(const std::vector<float>& last_plan, NearbyStates* nearby, int rollouts) noexcept {
    const int most = static_cast<int>(present_.size()), fitting = rollouts / (rollouts_of_state * most);
    last_plan_ = last_plan;
    nearby_ = nearby;
    states_ = nearby ? std::min({nearby->count(), most_states_, fitting / 2 * 2}) : 0;  // opposites together
    return (states_ + 1) * (states_ > 0 ? most : most - 2);
  }
  /// Begins the list of sequences.
  void clear(const std::vector<float>& plan) noexcept {
    sequences.set_samples(0);
    if (states_ == 0) return;
    add(plan);
    add(last_plan_);
  }
  void add(std::span<const float> sequence) noexcept {
    sequences.set_samples(sequences.samples() + 1);
    sequences.set_sample(sequences.samples() - 1, sequence);
  }
  /// Sums the costs, which `evaluate()` sets for the present start of the evaluator.
  void compare(auto evaluate) noexcept {
    std::fill(sums_.begin(), sums_.end(), 0.0);
    for (int state = -1; state < states_; ++state) {
      if (state >= 0) nearby_->start_at(state);
      evaluate();
      for (std::size_t k = 0; k < count(); ++k) sums_[k] += static_cast<double>(costs[k]);
      if (state < 0) std::copy_n(costs.data(), count(), present_.begin());
    }
    if (states_ > 0) nearby_->start_at(-1);
  }
  /// Writes the best sequence to `plan`, whose cost is known. Returns the cost of the plan.
  float choose(float known, std::vector<float>& plan) const noexcept {
    const auto best = std::min_element(sums_.begin(), sums_.begin() + sequences.samples()) - sums_.begin();
    const float cost = present_[static_cast<std::size_t>(best)];
    if (states_ == 0 && !(cost < known)) return known;
    sequences.get_sample(static_cast<int>(best), plan);
    return cost;
  }

  SequenceBatch sequences;
  AlignedBuffer costs;                 ///< from one state
  std::vector<std::uint8_t> collided;  ///< from the same state

 private:
  static constexpr int rollouts_of_state = 12;  ///< a solve needs so many for each from a nearby state

  std::size_t count() const noexcept { return static_cast<std::size_t>(sequences.samples()); }

  int most_states_;
  NearbyStates* nearby_ = nullptr;
  int states_ = 0;                ///< nearby states in use
  std::vector<float> last_plan_;  ///< [row]
  std::vector<float> present_;    ///< costs from the present state
  std::vector<double> sums_;      ///< costs from all states
};

}  // namespace slalom::detail
