#pragma once

#include <vector>

#include "slalom/solvers/solver.hpp"

namespace slalom::view {

/// The parts of a solve that the page draws, copied from the solver: some of the samples, evenly selected.
struct DrawnSolve {
  static constexpr float nudge = 0.01f;  ///< change of an input, for the derivative of the plan

  SolveResult figures;           ///< numbers of the solve, without its arrays
  std::size_t length = 0;        ///< values of a sequence; 0: there is no plan
  std::vector<float> sequences;  ///< [sequence][step][input]: plan, nominal, candidates, guides, and where
                                 ///< the spread is drawn the plan with each of its inputs changed by `nudge`
  std::size_t candidates = 0, guides = 0;  ///< sequences of each; guides in all iterations
  std::size_t guides_at_once = 1;          ///< guides of an iteration
  int samples = 0;                         ///< samples of which the candidates are some
  std::vector<float> costs, weights;       ///< those of the candidates
  std::vector<std::uint8_t> collided;      ///< 1 for each candidate that collides
  std::vector<float> variances;            ///< as in SolveResult

  /// Copies from a result. Allocates only where no earlier result had as many sequences.
  void take(const SolveResult& from, bool draws_spread);

 private:
  void add(std::span<const float> sequence) {
    sequences.insert(sequences.end(), sequence.begin(), sequence.end());
  }
  void add_candidates(const SolveResult& from);
};

}  // namespace slalom::view
