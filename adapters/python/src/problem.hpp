#pragma once

#include <any>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slalom/solvers/controlled.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::python {

/// The outcome of a control sequence in double.
struct Prediction {
  std::vector<double>
      states;  ///< [step][state], one step more than inputs; none if the problem tells costs alone
  double cost = 0;
  bool collided = false;
  std::vector<std::pair<std::string, double>> terms;  ///< the parts of the cost

  /// The states. Throws std::invalid_argument if there are none.
  const std::vector<double>& known_states() const {
    if (states.empty())
      throw std::invalid_argument(
          "Problem.rollout: returned costs alone; states need a pair (costs, states [K, T + 1, states])");
    return states;
  }
  /// Adds to the term with this name.
  void add(const std::string& name, double value) {
    for (auto& [known, sum] : terms) {
      if (known == name) {
        sum += value;
        return;
      }
    }
    terms.emplace_back(name, value);
  }
};

/// A problem in Python: a built-in or compiled one, or one made of callables.
class AnyProblem : public ControlledProblem {
 public:
  virtual std::unique_ptr<AnyProblem> clone() const = 0;
  /// Step `k` of the dynamics from a state.
  virtual std::vector<double> step(std::span<const double> state, std::span<const double> input, int k) = 0;
  /// `inputs` [step][input].
  virtual Prediction predict(std::span<const double> state, std::span<const double> inputs) = 0;
  /// Returns the trajectories of control sequences [sequence][`steps`][input], with rates and levels as in
  /// the last solve. `terms`: the names of the terms of `predict`. A problem that tells only sums has them at
  /// the last state.
  virtual Trajectories roll_out(std::span<const double> state, std::span<const float> sequences, int steps,
                                std::span<const std::string> terms);
  /// Exact derivatives (linearize.hpp) at a state and the inputs of step `k`: next state, A, B, cost,
  /// gradient, Hessian, kink; without inputs, those of the terminal cost. Empty if it has no code for them.
  virtual std::vector<std::vector<double>> expand(std::span<const double> /*state*/,
                                                  std::span<const double> /*input*/, int /*k*/) const {
    return {};
  }
  /// A solver on a GPU. Throws std::invalid_argument if the problem has no code for one.
  virtual std::unique_ptr<Solver> gpu_solver(const SolverOptions&) const {
    throw std::invalid_argument(
        "problem: has no code for a GPU: slalom.compile(problem, gpu=[90]) makes it "
        "(docs/gpu.md#from-python)");
  }
  /// Copies the memory that the problem declares to the GPU of such a solver again.
  virtual void refresh_gpu(Solver&) const noexcept {}
  /// Why the GPU of such a solver fails; empty if it does not.
  virtual std::string gpu_fault(const Solver&) const { return {}; }
  /// To be called before and after a solve. The argument is the PyObject that owns the solver's memory.
  virtual void begin(void* /*owner*/) {}
  virtual void finish() {}
  /// Calls a function with a pointer to each py::object that the problem holds.
  virtual void each_object(const std::function<void(void*)>&) {}
};

inline Trajectories AnyProblem::roll_out(std::span<const double> state, std::span<const float> sequences,
                                         int steps, std::span<const std::string>) {
  Trajectories all;
  const auto size = static_cast<std::size_t>(steps * inputs());
  for (std::size_t at = 0; at + size <= sequences.size(); at += size) {
    const Prediction one = predict(
        state, std::vector<double>(&sequences[at], &sequences[at] + static_cast<std::ptrdiff_t>(size)));
    all.states.insert(all.states.end(), one.known_states().begin(), one.states.end());
    all.costs.insert(all.costs.end(), static_cast<std::size_t>(steps) * one.terms.size(), 0.0);
    for (const auto& [name, value] : one.terms) all.costs.push_back(value);
    all.collisions.push_back(one.collided ? steps : -1);
  }
  return all;
}

/// A member of a problem that is compiled at run time: a `double` or an array of them, an Mlp, or a Field.
struct Parameter {
  enum class Kind { numbers, network, field };
  const char* name;
  Kind kind;
  std::span<double> values;              ///< numbers
  std::function<void(const void*)> set;  ///< takes the MlpParameters of a network, or a maps::Field
  bool is_empty = false;                 ///< whether a network has no weights, or a field no samples
};

/// A problem that is compiled at run time, in a library of its own (compiled_problem.hpp).
class CompiledProblem : public AnyProblem {
 public:
  /// The problem's members that can be changed between solves.
  virtual std::vector<Parameter> parameters() { return {}; }
  void begin(void*) override {
    for (const Parameter& each : parameters())
      if (each.is_empty && !given.contains(each.name))
        throw std::invalid_argument("compile: the member '" + std::string(each.name) +
                                    "' is empty: set it, by a keyword argument or as an attribute");
  }
  void each_object(const std::function<void(void*)>& visit) override {
    for (auto& [name, object] : given) visit(object_of(object));
  }
  std::string file;                         ///< the file that it was loaded from
  std::map<std::string, std::any> given;    ///< the py::object that a network or a field was set to, by name
  void* (*object_of)(std::any&) = nullptr;  ///< where the py::object is
};

/// A problem struct.
template <Problem P, class Base = AnyProblem>
class BuiltIn : public slalom::detail::ControlledEvaluator<P, Base> {
  using Controlled = slalom::detail::ControlledEvaluator<P, Base>;

 public:
  using State = slalom::detail::StateOf<P, double>;
  using Controlled::Controlled, Controlled::evaluator;

  std::unique_ptr<AnyProblem> clone() const override { return std::make_unique<BuiltIn>(*this); }
  P& problem() noexcept { return evaluator().problem(); }
  const P& problem() const noexcept { return evaluator().problem(); }

  std::vector<double> step(std::span<const double> state, std::span<const double> input, int k) override {
    std::vector<double> next(state.begin(), state.end());
    this->advance(next, input, k);
    return next;
  }

  Prediction predict(std::span<const double> state, std::span<const double> inputs) override {
    const std::size_t steps = inputs.size() / P::inputs;
    std::vector<State> states(steps + 1);
    CostTermsOf<P> terms;
    const Cost<double> cost = slalom::predict(problem(), to_state(state), to_inputs(inputs).data(),
                                              static_cast<int>(steps), states.data(), &terms);
    Prediction result{
        std::vector<double>(sizeof(State) / sizeof(double) * states.size()), cost.value, cost.collided, {}};
    for (const CostTerm& term : terms) result.terms.emplace_back(term.name, term.value);
    std::memcpy(result.states.data(), states.data(), result.states.size() * sizeof(double));
    return result;
  }

  Trajectories roll_out(std::span<const double> state, std::span<const float> sequences, int steps,
                        std::span<const std::string>) override {
    return slalom::roll_out<P>(evaluator(), to_state(state), sequences, steps);
  }

 private:
  static State to_state(std::span<const double> values) {
    State x;
    std::memcpy(&x, values.data(), sizeof x);
    return x;
  }
  static auto to_inputs(std::span<const double> values) {
    return slalom::detail::as_inputs<P::inputs>(values);
  }
};

}  // namespace slalom::python
