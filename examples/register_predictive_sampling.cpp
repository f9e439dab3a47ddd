// Linked into the program, this one line makes `slalom drive --method predictive_sampling` work.

#include <slalom/solvers/registry.hpp>

#include "predictive_sampling.hpp"

static const bool registered = (slalom::register_solver(PredictiveSamplingOptions{}), true);
