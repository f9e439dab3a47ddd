#pragma once

#include <algorithm>
#include <array>

#include "problem.hpp"
#include "slalom/core/problem_check.hpp"
#ifdef SLALOM_DERIVATIVES
#include "slalom/core/derivatives/linearize.hpp"
#endif
#ifdef SLALOM_GPU
#include "slalom/gpu/gpu.hpp"
#endif

/// The end of a source file that `slalom.compile` makes of a problem struct. This header and problem.hpp do
/// not need the headers of Python.
namespace slalom::python {

inline Parameter parameter_of(const char* name, double& value) {
  return {name, Parameter::Kind::numbers, {&value, 1}, {}};
}
template <std::size_t N>
Parameter parameter_of(const char* name, std::array<double, N>& values) {
  return {name, Parameter::Kind::numbers, values, {}};
}
template <int I, int O>
Parameter parameter_of(const char* name, Mlp<I, O>& network) {
  const auto set = [&network](const void* from) {
    network = Mlp<I, O>(*static_cast<const MlpParameters*>(from));
  };
  const auto weights = network.weights();
  return {
      name, Parameter::Kind::network, {}, set, std::ranges::all_of(weights, [](float w) { return w == 0; })};
}
/// A slalom::maps::Field, whose header only a source with one includes.
template <class Field>
requires requires(Field& field) {
  field.relative_to(0, 0).geometry().width;
}
Parameter parameter_of(const char* name, Field& field) {
  const auto set = [&field](const void* from) { field = *static_cast<const Field*>(from); };
  return {name, Parameter::Kind::field, {}, set, field.geometry().width * field.geometry().height == 1};
}

/// The problem struct `P`. `list(P&)` returns its parameters.
template <class P, std::vector<Parameter> (*list)(P&)>
class CompiledFrom final : public BuiltIn<P, CompiledProblem> {
 public:
  using BuiltIn<P, CompiledProblem>::BuiltIn;
  std::unique_ptr<AnyProblem> clone() const override { return std::make_unique<CompiledFrom>(*this); }
  std::vector<Parameter> parameters() override { return list(this->problem()); }
#ifdef SLALOM_DERIVATIVES
  std::vector<std::vector<double>> expand(std::span<const double> state, std::span<const double> input,
                                          int k) const override {
    const auto flat = [](const auto& values) {
      const auto* const first = reinterpret_cast<const double*>(&values);
      return std::vector<double>(first, first + sizeof values / sizeof(double));
    };
    const P& problem = this->problem();
    const auto x = slalom::detail::state_of<P, double>(state.data());
    if (input.empty()) {
      const auto end = expand_terminal_cost(problem, x);
      return {flat(x), {}, {}, {end.value}, flat(end.gradient), flat(end.hessian), {double{end.kink}}};
    }
    const auto u = slalom::detail::inputs_of<P, double>(input.data());
    const auto l = linearize(problem, x, u, k);
    const auto cost = expand_stage_cost(problem, x, u, k);
    return {flat(l.next),        flat(l.state_jacobian), flat(l.input_jacobian),       {cost.value},
            flat(cost.gradient), flat(cost.hessian),     {double{l.kink || cost.kink}}};
  }
#endif
#ifdef SLALOM_GPU
  std::unique_ptr<Solver> gpu_solver(const SolverOptions& options) const override {
    if (const auto* guided = options.get_if<SvgMppiOptions>())
      return std::make_unique<gpu::GpuSolver<P, SvgMppiOptions>>(this->problem(), *guided);
    return std::make_unique<gpu::GpuSolver<P, MppiOptions>>(this->problem(), *options.get_if<MppiOptions>());
  }
  void refresh_gpu(Solver& solver) const noexcept override {
    static_cast<gpu::DeviceSolver&>(solver).refresh();
  }
  std::string gpu_fault(const Solver& solver) const override {
    return static_cast<const gpu::DeviceSolver&>(solver).fault();
  }
#endif
};

}  // namespace slalom::python

/// Defines the function by which the library of a compiled problem makes one.
#define SLALOM_COMPILED_PROBLEM(P, list)                                                                     \
  static_assert(slalom::detail::check_problem<P>());                                                         \
  extern "C" __attribute__((visibility("default"))) slalom::python::CompiledProblem* slalom_make_problem() { \
    return new slalom::python::CompiledFrom<P, list>(P{});                                                   \
  }
