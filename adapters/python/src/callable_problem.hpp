#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <string_view>

#include "keywords.hpp"
#include "problem.hpp"

/// The arrays that callables of Python return.
namespace slalom::python {

template <class From, class Real>
void add_values(const char* from, py::ssize_t stride, py::ssize_t count, Real* sums) {
  for (py::ssize_t i = 0; i < count; ++i) {
    From value;
    std::memcpy(&value, from + i * stride, sizeof value);
    sums[i] += static_cast<Real>(value);
  }
}

/// Adds a column of an array [count, columns], or an array [count].
template <class Real>
void add_column(const py::array& array, py::ssize_t column, py::ssize_t count, Real* sums) {
  const py::ssize_t offset = array.ndim() == 2 ? column * array.strides(1) : 0;
  const char* const from = static_cast<const char*>(array.data()) + offset;
  if (py::isinstance<py::array_t<float>>(array)) {
    add_values<float>(from, array.strides(0), count, sums);
  } else if (py::isinstance<py::array_t<double>>(array)) {
    add_values<double>(from, array.strides(0), count, sums);
  } else {
    add_column(py::array_t<double, py::array::forcecast>(array), column, count, sums);
  }
}

/// Throws ValueError unless an array that a callable returned has a shape.
inline void check_shape(const std::string& what, const py::array& array,
                        const std::vector<py::ssize_t>& shape) {
  if (!std::ranges::equal(extents_of(array), shape))
    throw py::value_error("Problem." + what + ": returned shape " + shape_text(extents_of(array)) +
                          ", must be " + shape_text(shape));
}

/// The array that a callable returned, or the one that shares the memory of a tensor. Throws TypeError if it
/// is none, ValueError if its shape is another.
inline py::array array_of(const char* what, const py::object& result, const std::vector<py::ssize_t>& shape) {
  if (!py::hasattr(result, "__array__"))
    throw py::type_error(std::string("Problem.") + what + ": returned " +
                         py::repr(py::type::of(result)).cast<std::string>() + ", must be an array");
  const py::array array(result);
  check_shape(what, array, shape);
  return array;
}

/// Calls `visit(name, values)` for each term of the cost that a callable returned: an array [count], a
/// dictionary of such, or a pair of one of these and which samples collide, which is added to `collided`.
template <class Visit>
void visit_terms(const char* what, py::object result, py::ssize_t count, std::uint8_t* collided,
                 Visit&& visit) {
  if (py::isinstance<py::tuple>(result) && py::len(result) == 2) {
    const auto pair = py::reinterpret_borrow<py::tuple>(result);
    const py::array_t<bool, py::array::forcecast> hits(pair[1]);
    check_shape(std::string(what) + ": collided", hits, {count});
    for (py::ssize_t i = 0; i < count; ++i) collided[i] |= static_cast<std::uint8_t>(hits.at(i));
    result = pair[0];
  }
  if (!py::isinstance<py::dict>(result))
    return visit(std::string_view(what) == "terminal_cost" ? "terminal" : "stage",
                 array_of(what, result, {count}));
  for (const auto& [name, term] : py::reinterpret_borrow<py::dict>(result))
    visit(py::str(name), array_of(what, py::reinterpret_borrow<py::object>(term), {count}));
}

/// The parts of a problem of callables.
struct CallableParts {
  py::object dynamics, cost;  ///< callables, or None where there is a rollout
  py::object terminal_cost;   ///< callable or None
  int states = 0, inputs = 0;
  double dt = 0;  ///< s, duration of a step; 0: unknown
  std::vector<double> input_min, input_max, input_rate_max,
      input_levels;    ///< one value, one per input, or none
  py::object sampler;  ///< callable or None
  py::object rollout;  ///< callable that takes the place of dynamics and costs, or None

  std::array<py::object*, 5> callables() { return {&dynamics, &cost, &terminal_cost, &sampler, &rollout}; }
};

/// A problem made of callables on batches (docs/python-reference.md), which get arrays that must not be
/// written: views of the solver's memory, and what dynamics returned, which is not copied.
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
  double unit_variance(int input) const noexcept override {
    return in_levels() ? slalom::detail::unit_variance(levels_of(input), 0) : 0;
  }
  double input_step(int input) const noexcept override;
  bool in_levels() const noexcept override { return !parts_.input_levels.empty(); }
  void hold_rates(std::span<const double> previous, std::span<double> sequence) const noexcept override;
  void carry(std::span<const float> wanted, std::span<const double> held,
             std::span<double> remainder) const noexcept override;
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
    for (py::object* object : parts_.callables()) visit(object);
  }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override;

  const CallableParts& parts() const noexcept { return parts_; }
  double dt() const noexcept { return parts_.dt; }
  void set_dt(double dt);

 private:
  /// An input as a problem of its own, which has levels.
  struct OneInput {
    static constexpr int inputs = 1;
    double input_min, input_max, input_levels;
  };
  OneInput levels_of(int input) const noexcept {
    return {value_for(parts_.input_min, input, 0), value_for(parts_.input_max, input, 0),
            value_for(parts_.input_levels, input, 0)};
  }
  bool holds() const noexcept { return in_levels() || !parts_.input_rate_max.empty(); }
  template <class T>
  void hold(int input, std::span<T> values, std::span<T> carried) const noexcept;
  std::vector<float> held_sequences(const SequenceBatch& batch, int first, int count) const;
  void check_parts() const;
  struct Outcome {
    py::array costs;   ///< [K]
    py::array states;  ///< [K, steps + 1, states], or empty
  };
  Outcome outcome_of(const py::array& state, const py::array& u) const;
  Prediction roll_out_alone(std::span<const double> state, std::span<const double> inputs) const;
  void roll_out(const SequenceBatch& batch, int first, int count, float* costs, std::uint8_t* collided) const;
  void fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept override;
  void draw(SequenceBatch& noise, int first, int count, RandomKey key) const;
  py::array next(const py::array& x, const py::array& u, int k) const;
  py::object stage_cost(const py::array& x, const py::array& u, int k) const;
  py::object terminal_cost(const py::array& x) const { return parts_.terminal_cost(lent(x)); }

  CallableParts parts_;
  bool dynamics_take_k_ = false, cost_takes_k_ = false;  ///< the index of the step
  std::vector<double> state_;
  std::vector<float> previous_;
  mutable py::array_t<float> all_x_, all_u_;  ///< memory of the last rollout of a small batch
  py::handle owner_;                          ///< during a solve
  mutable std::exception_ptr error_;          ///< the first of a solve; guarded by the interpreter lock
};

}  // namespace slalom::python
