#pragma once

#include <string_view>

#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "slalom/solvers/solver_options.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

/// The methods with the parameters of the published program of Honda et al. (ICRA 2024), departures from the
/// paper included; the same as in configs/published.yaml.
namespace slalom {

/// `mppi` of the published program.
MppiOptions published_mppi();
/// `svg_mppi` of the published program.
SvgMppiOptions published_svg_mppi();
/// `reverse_mppi` of the published program.
ReverseMppiOptions published_reverse_mppi();
/// `sv_mpc` of the published program.
SvMpcOptions published_sv_mpc();
/// The program has no `cem`: bounds and horizon are those of the program's methods.
CemOptions published_cem();

/// Returns the options of a method by its name. Throws std::invalid_argument if there is none of that name.
SolverOptions published_solver_options(std::string_view method);

}  // namespace slalom
