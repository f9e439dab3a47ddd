#pragma once

#include "slalom/solvers/solver_options.hpp"
#include "support/adversary.hpp"

/// Controllers as state machines: calls in any order with any values, and what every plan promises.
namespace slalom::testing {

/// Numbers of calls and of plans.
struct ControllerTally {
  long calls = 0, plans = 0, ok = 0, other = 0, corrections = 0;
};

/// A controller of one method for some problem, and a few dozen calls of its functions. Throws Finding unless
/// every plan is finite, within the bounds and within the rates.
void call_any_controller(const SolverOptions& options, Adversary& adversary, ControllerTally& tally);

}  // namespace slalom::testing
