#pragma once

#include "slalom/evaluation/lap_log.hpp"

namespace slalom::tools {

/// Laps of the program that Honda et al. released (https://github.com/kohonda/proj-svg_mppi), driven in
/// Slalom's simulator: its own solver sources, one thread, in the place of Slalom's solver, on Berlin under
/// `--evaluation published`. So only the solver differs from the laps of `reproduce`, without the data races
/// and the asynchrony of the authors' logs. The solver is kept from lap to lap, as the program's node does.
///
/// `row` is a PaperRow's `released`, `scenario` "pt" or "oa". Empty if no lap of the row was driven.
std::optional<evaluation::LapLog> paper_program_laps(const std::string& row, const std::string& scenario);

}  // namespace slalom::tools
