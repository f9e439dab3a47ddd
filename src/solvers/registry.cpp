#include "slalom/solvers/make_solver.hpp"

#include <stdexcept>
#include <string>

namespace slalom {

namespace {
/// In the order of the alternatives of `SolverOptions`.
constexpr const char* names[] = {"mppi", "svg_mppi", "reverse_mppi", "sv_mpc", "cem"};
static_assert(std::size(names) == std::variant_size_v<SolverOptions>);

template <std::size_t I = 0>
SolverOptions default_of(std::size_t index) {
  if constexpr (I + 1 < std::variant_size_v<SolverOptions>) {
    if (index != I) return default_of<I + 1>(index);
  }
  return std::variant_alternative_t<I, SolverOptions>{};
}
}  // namespace

std::span<const char* const> solver_names() noexcept {
  return names;
}

SolverOptions solver_options(std::string_view name) {
  std::string known;
  for (std::size_t i = 0; i < std::size(names); ++i) {
    if (name == names[i]) return default_of(i);
    known += (i ? ", " : "") + std::string(names[i]);
  }
  throw std::invalid_argument("method: " + std::string(name) + " is not one of " + known);
}

const char* solver_name(const SolverOptions& options) noexcept {
  return names[options.index()];
}

std::unique_ptr<Solver> make_solver(const SolverOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  return std::visit([&](const auto& o) { return make_solver(o, inputs, std::move(pool)); }, options);
}

}  // namespace slalom
