#pragma once

#include <memory>

#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom::detail {

/// `svg_mppi` in `batches` batches: the form that the library uses by default. docs/algorithms/svg-mppi.md
/// derives it and says what each part is worth.
std::unique_ptr<Solver> make_guided_mppi(const SvgMppiOptions& options, int batches, int inputs,
                                         std::shared_ptr<ThreadPool> pool);

}  // namespace slalom::detail
