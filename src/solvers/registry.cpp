#include "slalom/solvers/registry.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/icem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom {

namespace {

/// Default options of every method, and the names in the same order.
struct Registry {
  std::vector<SolverOptions> methods{
      MppiOptions{},         //
      SvgMppiOptions{},      //
      ReverseMppiOptions{},  //
      SvMpcOptions{},        //
      CemOptions{},          //
      IcemOptions{},         //
      DialMpcOptions{},      //
  };
  std::vector<const char*> names;

  Registry() {
    for (const SolverOptions& method : methods) names.push_back(method.method());
  }
};

Registry& registry() {
  static Registry all;
  return all;
}

template <class Type>
void require(const SolverOptions& defaults, const char* option, const char* type) {
  if (defaults.find<Type>(option)) return;
  throw std::invalid_argument("method " + std::string(defaults.method()) + ": must declare the option " +
                              option + " of type " + type);
}

}  // namespace

std::span<const char* const> solver_names() noexcept {
  return registry().names;
}

SolverOptions solver_options(std::string_view name) {
  std::string known;
  for (const SolverOptions& method : registry().methods) {
    if (name == method.method()) return method;
    known += (known.empty() ? "" : ", ") + std::string(method.method());
  }
  throw std::invalid_argument("method: unknown method '" + std::string(name) + "', must be one of " + known);
}

void register_solver(SolverOptions defaults) {
  for (const char* name : registry().names)
    if (std::string_view(name) == defaults.method())
      throw std::invalid_argument("method " + std::string(name) + ": is registered already");
  require<int>(defaults, "horizon", "int");
  require<int>(defaults, "threads", "int");
  require<std::uint64_t>(defaults, "seed", "std::uint64_t");
  require<PerInput>(defaults, "input_min", "PerInput");
  require<PerInput>(defaults, "input_max", "PerInput");
  registry().methods.push_back(std::move(defaults));
  registry().names.push_back(registry().methods.back().method());
}

}  // namespace slalom
