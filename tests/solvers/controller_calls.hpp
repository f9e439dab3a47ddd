#pragma once

#include "slalom/solvers/solver_options.hpp"
#include "support/adversary.hpp"

/// Controllers as state machines: calls in any order with any values, and what every plan promises.
namespace slalom::testing {

/// A controller of one method for some problem, and a few dozen calls of its functions. Returns the number of
/// plans. Throws Finding unless every plan is finite, within the bounds and within the rates.
int call_any_controller(const SolverOptions& options, Adversary& adversary);

}  // namespace slalom::testing
