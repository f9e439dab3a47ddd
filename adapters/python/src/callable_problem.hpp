#pragma once

#include <exception>
#include <mutex>

#include "problem.hpp"

namespace slalom::python {

/// A problem made of callables on batches of K samples: dynamics(x[K, nx], u[K, nu]) -> x[K, nx],
/// cost(x, u) -> [K], terminal_cost(x) -> [K]. A cost may come as a pair (cost, collided). The inputs are
/// views of the solver's memory and what dynamics returns is handed on as it is: nothing is copied.
class CallableProblem final : public AnyProblem, public BatchEvaluator {
 public:
  CallableProblem(py::object dynamics, py::object cost, py::object terminal_cost, int states, int inputs,
                  double dt);

  std::unique_ptr<AnyProblem> clone() const override;
  std::string name() const override { return "Problem"; }
  int states() const noexcept override { return states_; }
  int inputs() const noexcept override { return inputs_; }
  const BatchEvaluator& evaluator() const noexcept override { return *this; }
  double time_step() const noexcept override { return dt_; }
  bool whole_batches() const noexcept override { return true; }
  void set_state(std::span<const double> state) override;
  std::vector<double> step(std::span<const double> state, std::span<const double> input) override;
  Prediction predict(std::span<const double> state, std::span<const double> inputs) override;
  void begin(py::handle owner) override;
  /// Throws what a callable has thrown during the solve.
  void finish() override;

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override;

  double dt() const noexcept { return dt_; }
  void set_dt(double dt);

 private:
  void roll_out(const SequenceBatch& batch, int first, int count, float* costs, std::uint8_t* collided) const;
  py::array next(const py::array& x, const py::array& u) const;
  template <class Real>
  void add_cost(const char* what, const py::object& result, py::ssize_t count, Real* costs,
                std::uint8_t* collided) const;

  py::object dynamics_, cost_, terminal_cost_;
  int states_, inputs_;
  double dt_;
  std::vector<float> state_;
  py::handle owner_;                  ///< during a solve
  mutable std::exception_ptr error_;  ///< the first of a solve; guarded by the interpreter's lock
};

}  // namespace slalom::python
