#pragma once

#include <exception>
#include <mutex>

#include "keywords.hpp"
#include "problem.hpp"

namespace slalom::python {

/// The parts of a problem of callables.
struct CallableParts {
  py::object dynamics, cost;
  py::object terminal_cost;  ///< callable or None
  int states = 0, inputs = 0;
  double dt = 0;                                             ///< s, duration of a step; 0: unknown
  std::vector<double> input_min, input_max, input_rate_max;  ///< one value, one per input, or none
  py::object sampler;                                        ///< callable or None
};

/// A problem made of callables on batches of K samples: dynamics(x[K, nx], u[K, nu]) -> x[K, nx],
/// cost(x, u) -> [K], terminal_cost(x) -> [K]. Dynamics and cost may take the index of the step as a
/// third parameter. A cost may consist of terms, {name: [K]}, or be a pair
/// (cost, collided). The functions get arrays that must not be written: views of the solver's
/// memory, and what dynamics returned, which is not copied.
class CallableProblem final : public AnyProblem, public BatchEvaluator, private Sampler {
 public:
  /// Throws std::invalid_argument with the rule that a part breaks.
  explicit CallableProblem(CallableParts parts);

  std::unique_ptr<AnyProblem> clone() const override;
  int states() const noexcept override { return parts_.states; }
  int inputs() const noexcept override { return parts_.inputs; }
  const BatchEvaluator& evaluator() const noexcept override { return *this; }
  double time_step() const noexcept override { return parts_.dt; }
  const Sampler* sampler() const noexcept override { return parts_.sampler.is_none() ? nullptr : this; }
  InputBounds stated_bounds() const override {
    return bounds_of(parts_.input_min, parts_.input_max, parts_.inputs);
  }
  double input_step(int input) const noexcept override;
  void hold_rates(std::span<const double> previous, std::span<double> sequence) const noexcept override;
  void set_previous_input(std::span<const double> u) noexcept override;
  bool whole_batches() const noexcept override { return true; }
  void set_state(std::span<const double> state) noexcept override;
  std::vector<double> step(std::span<const double> state, std::span<const double> input, int k) override;
  Prediction predict(std::span<const double> state, std::span<const double> inputs) override;
  Trajectories roll_out(std::span<const double> state, std::span<const float> sequences, int steps,
                        std::span<const std::string> terms) override;
  std::unique_ptr<Solver> gpu_solver(const SolverOptions&) const override {
    throw std::invalid_argument(
        "problem: callables of Python do not run on a GPU: write a struct in C++ (docs/gpu.md#from-python)");
  }
  void begin(void* owner) override;
  /// Rethrows the first exception of a callable during the solve.
  void finish() override;
  void each_object(const std::function<void(void*)>& visit) override {
    for (py::object* object : {&parts_.dynamics, &parts_.cost, &parts_.terminal_cost, &parts_.sampler})
      visit(object);
  }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override;

  const CallableParts& parts() const noexcept { return parts_; }
  double dt() const noexcept { return parts_.dt; }
  void set_dt(double dt);

 private:
  void roll_out(const SequenceBatch& batch, int first, int count, float* costs, std::uint8_t* collided) const;
  void hold_step(const SequenceBatch& batch, int k, int first, int count, std::vector<float>& held) const;
  void fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept override;
  void draw(SequenceBatch& noise, int first, int count, RandomKey key) const;
  py::array next(const py::array& x, const py::array& u, int k) const;
  py::object stage_cost(const py::array& x, const py::array& u, int k) const;
  py::object terminal_cost(const py::array& x) const { return parts_.terminal_cost(lent(x)); }

  CallableParts parts_;
  bool dynamics_take_k_ = false, cost_takes_k_ = false;  ///< the index of the step
  std::vector<float> state_, previous_;
  py::handle owner_;                  ///< during a solve
  mutable std::exception_ptr error_;  ///< the first of a solve; guarded by the interpreter lock
};

}  // namespace slalom::python
