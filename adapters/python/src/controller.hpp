#pragma once

#include <atomic>
#include <optional>

#include "keywords.hpp"
#include "problem.hpp"
#include "slalom/solvers/make_solver.hpp"

namespace slalom::python {

/// A problem and a method that solves it.
class Controller {
 public:
  Controller(const AnyProblem& problem, const SolverOptions& options);

  /// Solves without the interpreter's lock. `owner` is the Python object of this controller.
  void solve(py::handle owner, std::vector<double> state, const SolveRequest& request);
  void reset(std::uint64_t seed);
  void prepare();
  /// What was applied before the next solve, where the problem limits rates.
  void set_previous_input(std::vector<double> input);

  AnyProblem& problem() noexcept { return *problem_; }
  const Solver& solver() const noexcept { return *solver_; }
  const SolverOptions& options() const noexcept { return options_; }
  const SolveResult& result() const noexcept { return result_; }
  Status status() const noexcept { return status_; }
  /// How often it has solved, to tell whether a plan is still the last.
  std::uint64_t solves() const noexcept { return solves_; }
  /// The plan's inputs in double, [step][input].
  std::vector<double>& inputs() noexcept { return inputs_; }
  /// What the plan leads to; worked out when first asked for.
  Prediction& prediction();

 private:
  class Busy;

  void recall_input(double elapsed);

  std::unique_ptr<AnyProblem> problem_;
  SolverOptions options_;
  std::unique_ptr<Solver> solver_;
  SolveResult result_;
  Status status_ = Status::ok;
  std::uint64_t solves_ = 0;
  std::vector<double> state_, inputs_, previous_;
  bool told_ = true;  ///< what was applied before the next solve is in `previous_`
  std::optional<Prediction> prediction_;
  std::atomic<bool> busy_ = false;
};

void bind_controllers(py::module_& module);
void bind_problems(py::module_& module);
void bind_driving(py::module_& module);

}  // namespace slalom::python
