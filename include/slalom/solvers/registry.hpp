#pragma once

#include <concepts>
#include <memory>
#include <span>
#include <string_view>

#include "slalom/core/thread_pool.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/solvers/solver_options.hpp"

/// The methods that are known by name, and solvers by their options. The methods of the library are listed in
/// src/solvers/registry.cpp; everything that works with names (`slalom drive --method`, configuration files,
/// the Python package, the contract tests) knows those and every method that was registered.
namespace slalom {

/// The names of all methods, as configurations write them. The span is valid until the next registration.
std::span<const char* const> solver_names() noexcept;

/// The default options of a method. Throws std::invalid_argument that lists the names if it is unknown.
SolverOptions solver_options(std::string_view name);

/// The name of the method that options belong to.
inline const char* solver_name(const SolverOptions& options) noexcept {
  return options.method();
}

/// Adds a method with its default options to those known by name. To be called before other threads use the
/// registry, for instance at the start of `main`. Throws std::invalid_argument if the name is taken or an
/// option that every method has (see `SolverOptions::find`) is missing.
void register_solver(SolverOptions defaults);

/// A solver for problems with `inputs` inputs per step. Its threads are its own (as many as its option
/// `threads`) unless a pool is given to share. Throws std::invalid_argument that names the option, its value
/// and the rule if an option is out of range. Overloads for the options of one method stand beside them.
template <std::same_as<SolverOptions> Options>
std::unique_ptr<Solver> make_solver(const Options& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr) {
  return options.make(inputs, std::move(pool));
}

}  // namespace slalom
