#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "slalom/core/thread_pool.hpp"
#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

/// Solvers by their options or by their names, for any problem behind the seam of `BatchEvaluator`.
namespace slalom {

/// The options of any one method.
using SolverOptions = std::variant<MppiOptions, SvgMppiOptions, ReverseMppiOptions, SvMpcOptions, CemOptions>;

/// The names of all methods, as configurations write them.
std::span<const char* const> solver_names() noexcept;

/// The default options of a method. Throws std::invalid_argument that lists the names if there is no such
/// method.
SolverOptions solver_options(std::string_view name);

/// The name of the method that options belong to.
const char* solver_name(const SolverOptions& options) noexcept;

/// A solver for problems with `inputs` inputs a step. Threads are its own (as many as `options.threads`)
/// unless a pool is given to share. Throws std::invalid_argument that names the option, its value and the
/// rule where an option is out of range.
std::unique_ptr<Solver> make_solver(const MppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);
std::unique_ptr<Solver> make_solver(const SvgMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);
std::unique_ptr<Solver> make_solver(const ReverseMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);
std::unique_ptr<Solver> make_solver(const SvMpcOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);
std::unique_ptr<Solver> make_solver(const CemOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);
std::unique_ptr<Solver> make_solver(const SolverOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
