#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

#include "keywords.hpp"
#include "problem.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom::python {

/// A problem and a method that solves it. A copy continues bit for bit like the original; it shares the
/// threads and the callables of the problem.
class Controller {
 public:
  Controller(const AnyProblem& problem, const SolverOptions& options, bool on_gpu = false);

  /// Returns a copy. Throws std::runtime_error if another thread uses the controller.
  std::unique_ptr<Controller> copy();

  /// Solves without the interpreter lock. `owner` is the Python object of this controller.
  void solve(py::handle owner, std::vector<double> state, const SolveRequest& request) {
    solve({owner}, {std::move(state)}, request, 1);
  }
  /// Solves with many controllers, each from its own state. Throws before the first solve if a state or a
  /// time is not valid or a controller is in use, and afterwards the first exception of a callable.
  static void solve(const std::vector<py::handle>& owners, std::vector<std::vector<double>> states,
                    const SolveRequest& request, int threads);
  void reset(std::uint64_t seed);
  void prepare();
  /// Sets the input applied before the next solve, for problems with limits on input rates.
  void set_previous_input(const std::vector<double>& input);

  AnyProblem& problem() noexcept { return *problem_; }
  const Solver& solver() const noexcept { return core_.solver(); }
  bool on_gpu() const noexcept { return on_gpu_; }
  /// Why the GPU fails; empty if it does not.
  std::string gpu_fault() const { return on_gpu_ ? problem_->gpu_fault(solver()) : ""; }
  /// Copies the memory that the problem declares to the GPU again.
  void refresh_gpu() {
    if (on_gpu_) problem_->refresh_gpu(core_.solver());
  }
  const SolverOptions& options() const noexcept { return options_; }
  const SolveResult& result() const noexcept { return solver().result(); }
  /// The status of the last solve and of its prediction.
  Status checked_status() {
    if (core_.status() != Status::non_finite_state) prediction();
    return core_.status();
  }
  /// The number of values that the checks changed in the last solve, with the samples whose cost was nan.
  int corrections() {
    prediction();
    return core_.corrections() + nan_costs_;
  }
  /// The number of solves, which tells whether a plan is the last one.
  std::uint64_t solves() const noexcept { return solves_; }
  /// Whether it is in the state after its construction.
  bool is_new() const noexcept { return is_new_; }
  /// The plan's inputs in double, [step][input].
  std::span<const double> inputs() const noexcept { return core_.inputs(); }
  /// The states and the cost of the plan, computed on the first call.
  Prediction& prediction();
  void each_object(const std::function<void(void*)>& visit) { problem_->each_object(visit); }

 private:
  struct Release {
    void operator()(std::atomic<bool>* busy) const { *busy = false; }
  };
  using Busy = std::unique_ptr<std::atomic<bool>, Release>;
  /// Whether a thread uses the controller. A copy is not in use.
  struct Usage {
    Usage() = default;
    Usage(const Usage&) {}
    std::atomic<bool> busy = false;
  };

  Controller(const Controller&) = default;

  Busy use();
  bool start(py::handle owner, std::vector<double> state, const SolveRequest& request);
  void finish(std::int64_t nan_costs);
  void check_repeats();

  Polymorphic<AnyProblem> problem_;
  SolverOptions options_;
  bool on_gpu_;
  ControllerCore core_;
  std::uint64_t solves_ = 0;
  bool is_new_ = true;
  int nan_costs_ = 0;          ///< samples of the last solve whose cost was nan
  bool told_of_nan_ = false;   ///< whether a warning has told of such costs
  std::vector<double> state_;  ///< start of the last solve
  std::optional<Prediction> prediction_;
  Usage usage_;
};

/// The solution of a controller in Python. Its arrays are views of the controller's memory.
struct Plan {
  py::object owner;     ///< the controller
  std::uint64_t solve;  ///< Controller::solves of this plan

  void each_object(const auto& visit) { visit(&owner); }

  /// Throws std::runtime_error if the controller has solved again.
  Controller& controller() const {
    auto& c = owner.cast<Controller&>();
    if (c.solves() != solve)
      throw std::runtime_error(
          "plan: the controller has solved again; copy what you keep before the next solve");
    return c;
  }
  const SolveResult& result() const { return controller().result(); }
};

void bind_compiled(py::module_& module);
void bind_controllers(py::module_& module);
void bind_maps(py::module_& module);
void bind_plan(py::module_& module);
void bind_problems(py::module_& module);
void bind_risk(py::module_& module);
void bind_view(py::module_& module);

}  // namespace slalom::python

/// The type that Python sees: CompiledProblem for a compiled problem, whose own type is in its library.
template <>
struct pybind11::polymorphic_type_hook<slalom::python::AnyProblem> {
  /// Returns the address of the whole object and sets its type.
  static const void* get(const slalom::python::AnyProblem* problem, const std::type_info*& type) {
    if (const auto* compiled = dynamic_cast<const slalom::python::CompiledProblem*>(problem)) {
      type = &typeid(slalom::python::CompiledProblem);
      return compiled;
    }
    type = problem ? &typeid(*problem) : nullptr;
    return dynamic_cast<const void*>(problem);
  }
};
