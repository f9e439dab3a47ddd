#pragma once

/// Everything to solve a problem of one's own: problems, methods, controllers. The layers above (maps,
/// vehicle, sim) are included by their own headers.

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/derivatives/linearize.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/math.hpp"
#include "slalom/core/network/mlp.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/core/risk/risk_evaluator.hpp"
#include "slalom/core/status.hpp"
#include "slalom/core/version.hpp"
#include "slalom/solvers/controllers.hpp"
#include "slalom/solvers/feedback.hpp"
#include "slalom/solvers/proposals.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/solve_batch.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/solvers/solver_base.hpp"

// A warning for a source file that is compiled without optimisation.
#if !defined(__OPTIMIZE__) && !defined(SLALOM_ALLOW_UNOPTIMISED)
#warning "slalom: 40 times slower without optimisation: use -O2, or define SLALOM_ALLOW_UNOPTIMISED"
#endif
