#pragma once

#include <pybind11/numpy.h>

#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slalom/core/problem_evaluator.hpp"

namespace slalom::python {

namespace py = pybind11;

/// The outcome of a control sequence in double.
struct Prediction {
  std::vector<double> states;  ///< [step][state], one step more than inputs
  double cost = 0;
  bool collided = false;
};

/// A problem as Python holds it: one of ours, or one made of callables.
class AnyProblem {
 public:
  virtual ~AnyProblem() = default;
  virtual std::unique_ptr<AnyProblem> clone() const = 0;
  virtual std::string name() const = 0;
  virtual int states() const noexcept = 0;
  virtual int inputs() const noexcept = 0;
  virtual const BatchEvaluator& evaluator() const noexcept = 0;
  /// Where the next rollouts start; `states()` values.
  virtual void set_state(std::span<const double> state) = 0;
  /// One step of the dynamics from a state.
  virtual std::vector<double> step(std::span<const double> state, std::span<const double> input) = 0;
  /// `inputs` [step][input].
  virtual Prediction predict(std::span<const double> state, std::span<const double> inputs) = 0;
  /// To be called before and after a solve, with the Python object that owns the solver's memory.
  virtual void begin(py::handle) {}
  virtual void finish() {}
};

/// A problem struct of ours, at full speed.
template <Problem P>
class BuiltIn final : public AnyProblem {
 public:
  using State = slalom::detail::StateOf<P, double>;
  static constexpr int state_count = slalom::detail::state_size<P>;

  BuiltIn(P problem, std::string name) : evaluator_(std::move(problem)), name_(std::move(name)) {}

  std::unique_ptr<AnyProblem> clone() const override { return std::make_unique<BuiltIn>(*this); }
  std::string name() const override { return name_; }
  int states() const noexcept override { return state_count; }
  int inputs() const noexcept override { return P::inputs; }
  const BatchEvaluator& evaluator() const noexcept override { return evaluator_; }
  P& problem() noexcept { return evaluator_.problem(); }
  const P& problem() const noexcept { return evaluator_.problem(); }

  void set_state(std::span<const double> state) override { evaluator_.set_state(to_state(state)); }

  std::vector<double> step(std::span<const double> state, std::span<const double> input) override {
    const Prediction one = predict(state, input);
    return {one.states.begin() + state_count, one.states.end()};
  }

  Prediction predict(std::span<const double> state, std::span<const double> inputs) override {
    const std::size_t steps = inputs.size() / P::inputs;
    std::vector<Input<double, P::inputs>> sequence(steps);
    std::memcpy(sequence.data(), inputs.data(), inputs.size_bytes());
    std::vector<State> states(steps + 1);
    const Cost<double> cost =
        slalom::predict(problem(), to_state(state), sequence.data(), static_cast<int>(steps), states.data());
    Prediction result{std::vector<double>(states.size() * state_count), cost.value, cost.collided};
    std::memcpy(result.states.data(), states.data(), result.states.size() * sizeof(double));
    return result;
  }

 private:
  static State to_state(std::span<const double> values) {
    State state;
    std::memcpy(&state, values.data(), sizeof state);
    return state;
  }

  ProblemEvaluator<P> evaluator_;
  std::string name_;
};

}  // namespace slalom::python
