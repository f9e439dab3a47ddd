#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "slalom/core/final_check.hpp"
#include "slalom/core/polymorphic.hpp"
#include "slalom/solvers/prediction_errors.hpp"
#include "slalom/solvers/solver_options.hpp"

namespace slalom {

/// A problem as controllers see it, whatever its type: the evaluator of its rollouts, and what it states
/// of its inputs. Control sequences are in double, [step][input].
class ControlledProblem {
 public:
  virtual ~ControlledProblem() = default;

  virtual int inputs() const noexcept = 0;  ///< inputs per step
  /// The evaluator of the rollouts.
  virtual const BatchEvaluator& evaluator() const noexcept = 0;
  /// Sets the state in which the next rollouts start, as its scalars.
  virtual void set_state(std::span<const double> state) noexcept = 0;
  virtual int states() const noexcept = 0;  ///< scalars of a state
  /// Moves a state forward by step `k`. Returns false if the problem has no function for it.
  virtual bool advance(std::span<double> /*state*/, std::span<const double> /*input*/,
                       int /*k*/) const noexcept {
    return false;
  }
  /// The bounds of the inputs. Throws std::invalid_argument if the problem states invalid ones.
  virtual InputBounds stated_bounds() const { return InputBounds(inputs()); }
  /// The unit of an input's variances, input^2, where that of the method does not fit; otherwise 0.
  virtual double unit_variance(int /*input*/) const noexcept { return 0; }
  /// The largest change of an input in a step; infinite without a limit.
  virtual double input_step(int /*input*/) const noexcept { return std::numeric_limits<double>::infinity(); }
  /// Whether the problem has `input_levels`. In place of the input applied before, rollouts then start from
  /// the remainder that is left of the inputs applied before.
  virtual bool in_levels() const noexcept { return false; }
  /// Sets the input applied before the next rollouts, or the remainder.
  virtual void set_previous_input(std::span<const double> /*u*/) noexcept {}
  /// Limits the rates of `sequence`, in place, or moves it to the levels (hold_input_rates).
  virtual void hold_rates(std::span<const double> /*previous*/,
                          std::span<double> /*sequence*/) const noexcept {}
  /// Moves the remainder on by the applied steps of a plan: `wanted` by the method, `held` in levels, both
  /// [step][input].
  virtual void carry(std::span<const float> /*wanted*/, std::span<const double> /*held*/,
                     std::span<double> /*remainder*/) const noexcept {}
};

/// The part of a controller that is the same for every problem: bounds, the inputs that are being applied,
/// and the final check. `Controller` and the controllers of other languages are built on it: they `begin` a
/// solve, let the solver solve, `finish`, and check their prediction. The problem is an argument, since a
/// copied controller has its own; it must be the one given at construction or a copy of it.
class ControllerCore {
 public:
  /// A function that makes a solver from options.
  using SolverFactory = std::function<std::unique_ptr<Solver>(const SolverOptions&)>;

  /// Makes the solver by `make` from the options, with bounds narrowed to the problem's and variances in its
  /// units. Throws std::invalid_argument if the problem states invalid bounds or the options have none, and
  /// what `make` throws.
  ControllerCore(const ControlledProblem& problem, const SolverOptions& options, const SolverFactory& make);
  /// Uses a solver with bounds of its own. Throws std::invalid_argument if it is null or made for another
  /// number of inputs.
  ControllerCore(const ControlledProblem& problem, std::unique_ptr<Solver> solver);

  /// Returns the options with the bounds narrowed to those of the problem.
  static SolverOptions within_bounds(const ControlledProblem& problem, SolverOptions options);

  /// Sets the problem to a state and to the input that is being applied. Returns false, and the last plan
  /// remains, if the state is not finite or a time of the request is not valid.
  bool begin(ControlledProblem& problem, std::span<const double> state, const SolveRequest& request) noexcept;
  /// Solves from that state with `evaluator`, which is that of the problem or wraps it.
  void solve(ControlledProblem& problem, const BatchEvaluator& evaluator,
             const SolveRequest& request) noexcept;
  /// Takes the plan from the solver, within rates, levels and bounds.
  void finish(const ControlledProblem& problem) noexcept;
  /// Checks the predicted states [step][scalar]: one that is not finite becomes the one before it, and the
  /// first `start`.
  void check_states(std::span<const double> start, std::span<double> states) noexcept;
  /// Checks the cost of the plan, or a part of it: one that is not finite becomes the largest double.
  void check_cost(double& cost) noexcept { correct(slalom::check_cost(cost)); }

  /// Sets the input applied before the next solve. Values outside the bounds are moved into them; values that
  /// are not finite are ignored.
  void set_previous_input(std::span<const double> u) noexcept;
  /// Resets the solver, with random numbers from `seed`, and the inputs to those before the first solve.
  void reset(const ControlledProblem& problem, std::uint64_t seed) noexcept;

  Solver& solver() noexcept { return *solver_; }                       ///< the solver in use
  const Solver& solver() const noexcept { return *solver_; }           ///< the solver in use
  const InputBounds& bounds() const noexcept { return bounds_; }       ///< the bounds of the inputs
  Status status() const noexcept { return status_; }                   ///< outcome of the last solve
  std::span<const double> inputs() const noexcept { return inputs_; }  ///< inputs of the plan, [step][input]
  /// Number of values that checks have changed since the last solve began.
  int corrections() const noexcept { return corrections_; }

 private:
  void connect(const ControlledProblem& problem);
  void rest(const ControlledProblem& problem) noexcept;
  bool predict(const ControlledProblem& problem, double elapsed) noexcept;
  void recall_input(const ControlledProblem& problem, double elapsed) noexcept;
  void correct(int changed) noexcept;

  InputBounds bounds_;
  Polymorphic<Solver> solver_;
  std::vector<double> inputs_;     ///< [step][input]
  std::vector<double> previous_;   ///< valid input applied before the last solve, or the remainder
  std::vector<double> given_;      ///< argument of the last set_previous_input
  std::vector<double> before_;     ///< inputs of a step, for the check of the next one
  std::vector<double> reach_;      ///< largest change of each input in a step
  std::vector<double> state_;      ///< start of the last solve
  std::vector<double> predicted_;  ///< the state that was predicted for the present time
  std::vector<double> moved_;      ///< the same a step later, or a state near it
  PredictionErrors errors_;
  bool has_state_ = false;  ///< whether there was a solve since the last reset
  bool told_ = true;        ///< whether the next solve uses `given_`
  Status status_ = Status::ok;
  int corrections_ = 0;
};

}  // namespace slalom
