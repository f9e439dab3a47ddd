#pragma once

#include "slalom/solvers/solver_base.hpp"
#include "solvers/methods/control_term.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// Lets a result show the samples of `set`.
void bind_samples(const SampleSet& set, SolveResult& result) noexcept;

/// Writes the samples of `set`, their statistics and the sums of their weights to a result.
void report_samples(const SampleSet& set, const BatchStatistics& statistics, const WeightSums<double>& sums,
                    SolveResult& result) noexcept;

}  // namespace slalom::detail
