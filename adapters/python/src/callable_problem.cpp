#include "callable_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slalom::python {

namespace {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i ? ", " : "") + std::to_string(array.shape(i));
  return text + ")";
}

void make_read_only(py::array& array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
}

template <class From, class Real>
void add_values(const py::array& values, py::ssize_t count, Real* sums) {
  const char* from = static_cast<const char*>(values.data());
  const py::ssize_t stride = values.strides(0);
  for (py::ssize_t i = 0; i < count; ++i) {
    From value;
    std::memcpy(&value, from + i * stride, sizeof value);
    sums[i] += static_cast<Real>(value);
  }
}

}  // namespace

CallableProblem::CallableProblem(py::object dynamics, py::object cost, py::object terminal_cost, int states,
                                 int inputs, double dt)
    : dynamics_(std::move(dynamics)),
      cost_(std::move(cost)),
      terminal_cost_(std::move(terminal_cost)),
      states_(states),
      inputs_(inputs),
      state_(static_cast<std::size_t>(std::max(states, 0))) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("Problem." + what);
  };
  require(PyCallable_Check(dynamics_.ptr()), "dynamics: must be callable");
  require(PyCallable_Check(cost_.ptr()), "cost: must be callable");
  require(terminal_cost_.is_none() || PyCallable_Check(terminal_cost_.ptr()),
          "terminal_cost: must be callable or None");
  require(states >= 1 && states <= 10000, "states: " + std::to_string(states) + " must be in [1, 10000]");
  require(inputs >= 1 && inputs <= 10000, "inputs: " + std::to_string(inputs) + " must be in [1, 10000]");
  set_dt(dt);
}

void CallableProblem::set_dt(double dt) {
  if (!(dt >= 0 && std::isfinite(dt)))
    throw std::invalid_argument("Problem.dt: " + std::to_string(dt) +
                                " must be finite and at least 0 (0: not known)");
  dt_ = dt;
}

std::unique_ptr<AnyProblem> CallableProblem::clone() const {
  return std::make_unique<CallableProblem>(dynamics_, cost_, terminal_cost_, states_, inputs_, dt_);
}

void CallableProblem::set_state(std::span<const double> state) {
  std::transform(state.begin(), state.end(), state_.begin(), [](double v) { return static_cast<float>(v); });
}

void CallableProblem::begin(py::handle owner) {
  owner_ = owner;
  error_ = nullptr;
}

void CallableProblem::finish() {
  owner_ = {};
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

py::array CallableProblem::next(const py::array& x, const py::array& u) const {
  const py::object result = dynamics_(x, u);
  if (!py::isinstance<py::array>(result))
    throw py::type_error("Problem.dynamics: returned " + py::repr(py::type::of(result)).cast<std::string>() +
                         ", must be an array");
  auto array = py::reinterpret_borrow<py::array>(result);
  if (array.ndim() != 2 || array.shape(0) != x.shape(0) || array.shape(1) != states_)
    throw py::value_error("Problem.dynamics: returned shape " + shape_text(array) + ", must be " +
                          shape_text(x));
  return array;
}

template <class Real>
void CallableProblem::add_cost(const char* what, const py::object& result, py::ssize_t count, Real* costs,
                               std::uint8_t* collided) const {
  py::object values = result;
  if (py::isinstance<py::tuple>(result) && py::len(result) == 2) {
    values = py::reinterpret_borrow<py::tuple>(result)[0];
    const auto hits =
        py::array_t<bool, py::array::forcecast>::ensure(py::reinterpret_borrow<py::tuple>(result)[1]);
    if (!hits || hits.ndim() != 1 || hits.shape(0) != count)
      throw py::value_error(std::string("Problem.") + what + ": collided must have shape (" +
                            std::to_string(count) + ",)");
    for (py::ssize_t i = 0; i < count; ++i) collided[i] |= static_cast<std::uint8_t>(hits.at(i));
  }
  if (!py::isinstance<py::array>(values))
    throw py::type_error(std::string("Problem.") + what + ": returned " +
                         py::repr(py::type::of(values)).cast<std::string>() + ", must be an array");
  auto array = py::reinterpret_borrow<py::array>(values);
  if (array.ndim() != 1 || array.shape(0) != count)
    throw py::value_error(std::string("Problem.") + what + ": returned shape " + shape_text(array) +
                          ", must be (" + std::to_string(count) + ",)");
  if (py::isinstance<py::array_t<float>>(array)) {
    add_values<float>(array, count, costs);
  } else if (py::isinstance<py::array_t<double>>(array)) {
    add_values<double>(array, count, costs);
  } else {
    const auto converted = py::array_t<double, py::array::forcecast>::ensure(array);
    if (!converted) throw py::error_already_set();
    add_values<double>(converted, count, costs);
  }
}

void CallableProblem::roll_out(const SequenceBatch& batch, int first, int count, float* costs,
                               std::uint8_t* collided) const {
  // Columns lie together in memory, as the inputs do, so that the callables work on contiguous columns.
  constexpr py::ssize_t width = sizeof(float);
  py::array x(py::dtype::of<float>(), {py::ssize_t{count}, py::ssize_t{states_}}, {width, width * count});
  float* values = static_cast<float*>(x.mutable_data());
  for (const float value : state_) values = std::fill_n(values, count, value);
  std::fill_n(costs, count, 0.0f);
  std::fill_n(collided, count, std::uint8_t{0});
  for (int k = 0; k < batch.steps(); ++k) {
    py::array u(py::dtype::of<float>(), {py::ssize_t{count}, py::ssize_t{inputs_}},
                {width, width * batch.stride()}, batch.row(k, 0) + first, owner_);
    make_read_only(u);
    add_cost("cost", cost_(x, u), count, costs, collided);
    x = next(x, u);
  }
  if (!terminal_cost_.is_none()) add_cost("terminal_cost", terminal_cost_(x), count, costs, collided);
}

void CallableProblem::evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                               std::uint8_t* collided) const noexcept {
  const py::gil_scoped_acquire lock;
  try {
    if (!error_) {
      roll_out(batch, first, count, costs + first, collided + first);
      return;
    }
  } catch (...) {
    error_ = std::current_exception();
  }
  std::fill_n(costs + first, count, std::numeric_limits<float>::infinity());
  std::fill_n(collided + first, count, std::uint8_t{0});
}

std::vector<double> CallableProblem::step(std::span<const double> state, std::span<const double> input) {
  const py::array_t<double> x({py::ssize_t{1}, py::ssize_t{states_}}, state.data());
  const py::array_t<double> u({py::ssize_t{1}, py::ssize_t{inputs_}}, input.data());
  const auto result = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(next(x, u));
  return {result.data(), result.data() + states_};
}

Prediction CallableProblem::predict(std::span<const double> state, std::span<const double> inputs) {
  Prediction result;
  result.states.assign(state.begin(), state.end());
  const auto nx = static_cast<std::size_t>(states_), nu = static_cast<std::size_t>(inputs_);
  const std::size_t steps = inputs.size() / nu;
  std::uint8_t collided = 0;
  std::vector<double> now(state.begin(), state.end());
  for (std::size_t k = 0; k < steps; ++k) {
    const py::array_t<double> x({py::ssize_t{1}, py::ssize_t{states_}}, now.data());
    const py::array_t<double> u({py::ssize_t{1}, py::ssize_t{inputs_}}, &inputs[k * nu]);
    add_cost("cost", cost_(x, u), 1, &result.cost, &collided);
    now = step(now, inputs.subspan(k * nu, nu));
    result.states.insert(result.states.end(), now.begin(), now.begin() + static_cast<std::ptrdiff_t>(nx));
  }
  if (!terminal_cost_.is_none()) {
    const py::array_t<double> x({py::ssize_t{1}, py::ssize_t{states_}}, now.data());
    add_cost("terminal_cost", terminal_cost_(x), 1, &result.cost, &collided);
  }
  result.collided = collided != 0;
  return result;
}

}  // namespace slalom::python
