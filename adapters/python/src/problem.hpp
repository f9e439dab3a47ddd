#pragma once

#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/solver_options.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::python {

/// The outcome of a control sequence in double.
struct Prediction {
  std::vector<double> states;  ///< [step][state], one step more than inputs
  double cost = 0;
  bool collided = false;
  std::vector<std::pair<std::string, double>> terms;  ///< the parts of the cost

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

/// A problem in Python: a built-in one, or one made of callables.
class AnyProblem {
 public:
  virtual ~AnyProblem() = default;
  virtual std::unique_ptr<AnyProblem> clone() const = 0;
  virtual int states() const noexcept = 0;
  virtual int inputs() const noexcept = 0;
  virtual const BatchEvaluator& evaluator() const noexcept = 0;
  /// Sets the start of the next rollouts; `states()` values.
  virtual void set_state(std::span<const double> state) = 0;
  /// Step `k` of the dynamics from a state.
  virtual std::vector<double> step(std::span<const double> state, std::span<const double> input, int k) = 0;
  /// `inputs` [step][input].
  virtual Prediction predict(std::span<const double> state, std::span<const double> inputs) = 0;
  /// Returns the trajectories of control sequences [sequence][`steps`][input], with rates and levels as in
  /// the last solve. `terms`: the names of the terms of `predict`. A problem that tells only sums has them at
  /// the last state.
  virtual Trajectories roll_out(std::span<const double> state, std::span<const float> sequences, int steps,
                                std::span<const std::string> terms);
  /// Bounds of the problem for an input; infinite if it has none.
  virtual double input_min(int /*input*/) const { return -std::numeric_limits<double>::infinity(); }
  virtual double input_max(int /*input*/) const { return std::numeric_limits<double>::infinity(); }
  /// The unit of an input's variances, input^2; not 1 for an input in levels.
  virtual double unit_variance(int /*input*/) const { return 0; }
  /// Limits the rates of u [step][input], where `previous` was applied before, if the problem limits rates.
  virtual void hold_rates(std::span<const double> /*previous*/, std::span<double> /*u*/) const {}
  /// Sets the input applied before the next rollouts if the problem limits rates; with levels, the remainder.
  virtual void set_previous_input(std::span<const double>) {}
  /// Moves the remainder of a problem with levels on by the applied steps of a plan: `wanted` by the method,
  /// `held` in levels, both [step][input]. Returns false for other problems.
  virtual bool carry(std::span<const float> /*wanted*/, std::span<const double> /*held*/,
                     std::span<double> /*remainder*/) const {
    return false;
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
};

inline Trajectories AnyProblem::roll_out(std::span<const double> state, std::span<const float> sequences,
                                         int steps, std::span<const std::string>) {
  Trajectories all;
  const auto size = static_cast<std::size_t>(steps * inputs());
  for (std::size_t at = 0; at + size <= sequences.size(); at += size) {
    const Prediction one = predict(
        state, std::vector<double>(&sequences[at], &sequences[at] + static_cast<std::ptrdiff_t>(size)));
    all.states.insert(all.states.end(), one.states.begin(), one.states.end());
    all.costs.insert(all.costs.end(), static_cast<std::size_t>(steps) * one.terms.size(), 0.0);
    for (const auto& [name, value] : one.terms) all.costs.push_back(value);
    all.collisions.push_back(one.collided ? steps : -1);
  }
  return all;
}

/// A parameter of a problem that is compiled at run time: a `double` member, or an array of them.
struct Parameter {
  const char* name;
  std::span<double> values;
};

/// A problem that is compiled at run time, in a library of its own (compiled_problem.hpp).
class CompiledProblem : public AnyProblem {
 public:
  /// The problem's members that can be changed between solves.
  virtual std::vector<Parameter> parameters() { return {}; }
  std::string file;  ///< the file that it was loaded from
};

/// A problem struct.
template <Problem P, class Base = AnyProblem>
class BuiltIn : public Base {
 public:
  using State = slalom::detail::StateOf<P, double>;
  static constexpr int state_count = slalom::detail::state_size<P>;

  explicit BuiltIn(P problem) : evaluator_(std::move(problem)) {}

  std::unique_ptr<AnyProblem> clone() const override { return std::make_unique<BuiltIn>(*this); }
  int states() const noexcept override { return state_count; }
  int inputs() const noexcept override { return P::inputs; }
  const BatchEvaluator& evaluator() const noexcept override { return evaluator_; }
  P& problem() noexcept { return evaluator_.problem(); }
  const P& problem() const noexcept { return evaluator_.problem(); }

  void set_state(std::span<const double> state) override { evaluator_.set_state(to<State>(state)); }

  std::vector<double> step(std::span<const double> state, std::span<const double> input, int) override {
    const Prediction one = predict(state, input);
    return {one.states.begin() + state_count, one.states.end()};
  }

  Prediction predict(std::span<const double> state, std::span<const double> inputs) override {
    const std::size_t steps = inputs.size() / P::inputs;
    std::vector<State> states(steps + 1);
    CostTermsOf<P> terms;
    const Cost<double> cost = slalom::predict(problem(), to<State>(state), to_sequence(inputs).data(),
                                              static_cast<int>(steps), states.data(), &terms);
    Prediction result{std::vector<double>(states.size() * state_count), cost.value, cost.collided, {}};
    for (const CostTerm& term : terms) result.terms.emplace_back(term.name, term.value);
    std::memcpy(result.states.data(), states.data(), result.states.size() * sizeof(double));
    return result;
  }

  Trajectories roll_out(std::span<const double> state, std::span<const float> sequences, int steps,
                        std::span<const std::string>) override {
    return slalom::roll_out<P>(evaluator_, to<State>(state), sequences, steps);
  }

  double input_min(int input) const override { return slalom::detail::min_input(problem(), input); }
  double input_max(int input) const override { return slalom::detail::largest_input(problem(), input); }
  double unit_variance(int input) const override { return slalom::detail::unit_variance(problem(), input); }
  void hold_rates([[maybe_unused]] std::span<const double> previous,
                  [[maybe_unused]] std::span<double> u) const override {
    if constexpr (slalom::detail::carries_inputs<P>) {
      auto sequence = to_sequence(u);
      hold_input_rates(problem(), to<U>(previous), sequence.data(), static_cast<int>(sequence.size()));
      std::memcpy(u.data(), sequence.data(), u.size_bytes());
    }
  }
  void set_previous_input([[maybe_unused]] std::span<const double> u) override {
    if constexpr (slalom::detail::carries_inputs<P>) evaluator_.set_previous_input(to<U>(u));
  }
  bool carry([[maybe_unused]] std::span<const float> wanted, [[maybe_unused]] std::span<const double> held,
             [[maybe_unused]] std::span<double> remainder) const override {
    if constexpr (slalom::detail::has_levels<P>) {
      const auto sequence = to_sequence(held);
      auto now = to<U>(remainder);
      carry_remainder(problem(), wanted.data(), sequence.data(), static_cast<int>(sequence.size()), now);
      std::memcpy(remainder.data(), &now, sizeof now);
    }
    return slalom::detail::has_levels<P>;
  }

 private:
  using U = Input<double, P::inputs>;

  template <class T>
  static T to(std::span<const double> values) {
    T made;
    std::memcpy(&made, values.data(), sizeof made);
    return made;
  }
  static std::vector<U> to_sequence(std::span<const double> values) {
    std::vector<U> sequence(values.size() / P::inputs);
    std::memcpy(sequence.data(), values.data(), values.size_bytes());
    return sequence;
  }

  ProblemEvaluator<P> evaluator_;
};

}  // namespace slalom::python
