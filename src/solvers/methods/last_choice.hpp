#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "slalom/core/sequence_batch.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom::detail {

/// The sequences among which a solve chooses at its end, by their mean cost over the present state and others
/// near it.
struct LastChoice {
  SequenceBatch sequences;
  AlignedBuffer costs;                 ///< from one state
  std::vector<std::uint8_t> collided;  ///< from the same state
  std::vector<double> present, sums;   ///< costs from the present state, and from all

  LastChoice(int horizon, int inputs, int most)
      : sequences(horizon, inputs, most),
        costs(sequences.stride()),
        collided(static_cast<std::size_t>(sequences.stride())),
        present(static_cast<std::size_t>(most)),
        sums(present) {}

  void clear() noexcept { sequences.set_samples(0); }
  void add(std::span<const float> sequence) noexcept {
    sequences.set_samples(sequences.samples() + 1);
    sequences.set_sample(sequences.samples() - 1, sequence);
  }
  /// The first of the cheapest, if `evaluate()` sets the costs and there are `count` nearby states.
  int cheapest(NearbyStates* nearby, int count, auto evaluate) noexcept {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int state = -1; state < count; ++state) {
      if (state >= 0) nearby->start_at(state);
      evaluate();
      for (int k = 0; k < sequences.samples(); ++k) {
        const auto at = static_cast<std::size_t>(k);
        if (state < 0) present[at] = static_cast<double>(costs[k]);
        sums[at] += static_cast<double>(costs[k]);
      }
    }
    if (count > 0) nearby->start_at(-1);
    return static_cast<int>(std::min_element(sums.begin(), sums.begin() + sequences.samples()) -
                            sums.begin());
  }
};

}  // namespace slalom::detail
