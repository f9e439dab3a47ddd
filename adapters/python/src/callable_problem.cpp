#include "callable_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace slalom::python {

namespace {

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

CallableProblem::CallableProblem(CallableParts parts)
    : parts_(std::move(parts)),
      state_(static_cast<std::size_t>(std::max(parts_.states, 0))),
      previous_(static_cast<std::size_t>(std::max(parts_.inputs, 0))) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("Problem." + what);
  };
  const auto require_callable = [&](const py::object& part, const std::string& name, bool optional) {
    require(PyCallable_Check(part.ptr()) || (optional && part.is_none()),
            name + ": must be callable" + (optional ? " or None" : ""));
  };
  require_callable(parts_.dynamics, "dynamics", false);
  require_callable(parts_.cost, "cost", false);
  require_callable(parts_.terminal_cost, "terminal_cost", true);
  require_callable(parts_.sampler, "sampler", true);
  const int states = parts_.states, inputs = parts_.inputs;
  require(states >= 1 && states <= 10000, "states: " + std::to_string(states) + " must be in [1, 10000]");
  require(inputs >= 1 && inputs <= 10000, "inputs: " + std::to_string(inputs) + " must be in [1, 10000]");
  const auto require_count = [&](const std::vector<double>& values, const std::string& what) {
    require(values.size() <= 1 || static_cast<int>(values.size()) == inputs,
            what + ": has " + std::to_string(values.size()) + " values, must have 1 or " +
                std::to_string(inputs));
  };
  require_count(parts_.input_min, "input_min");
  require_count(parts_.input_max, "input_max");
  require_count(parts_.input_rate_max, "input_rate_max");
  for (const double rate : parts_.input_rate_max)
    require(rate >= 0, "input_rate_max: " + std::to_string(rate) + " must be at least 0");
  set_dt(parts_.dt);
  require(parts_.input_rate_max.empty() || parts_.dt > 0,
          "input_rate_max: requires dt, the duration of a step");
}

namespace {
double entry(const std::vector<double>& values, int input, double otherwise) {
  if (values.empty()) return otherwise;
  return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(input)];
}
}  // namespace

double CallableProblem::input_min(int input) const {
  return entry(parts_.input_min, input, AnyProblem::input_min(input));
}
double CallableProblem::input_max(int input) const {
  return entry(parts_.input_max, input, AnyProblem::input_max(input));
}
void CallableProblem::set_previous_input(std::span<const double> u) {
  std::transform(u.begin(), u.end(), previous_.begin(), [](double v) { return static_cast<float>(v); });
}
void CallableProblem::hold_rates(std::span<const double> previous, std::span<double> u) const {
  if (parts_.input_rate_max.empty()) return;
  const auto nu = static_cast<std::size_t>(parts_.inputs);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double before = i < nu ? previous[i] : u[i - nu];
    const double reach = entry(parts_.input_rate_max, static_cast<int>(i % nu), 0) * parts_.dt;
    u[i] = std::clamp(u[i], before - reach, before + reach);
  }
}

void CallableProblem::set_dt(double dt) {
  if (!(dt >= 0 && std::isfinite(dt)))
    throw std::invalid_argument("Problem.dt: " + std::to_string(dt) +
                                " must be finite and at least 0 (0: not known)");
  if (dt == 0 && !parts_.input_rate_max.empty())
    throw std::invalid_argument("Problem.dt: must be positive, since input_rate_max is set");
  parts_.dt = dt;
}

std::unique_ptr<AnyProblem> CallableProblem::clone() const {
  return std::make_unique<CallableProblem>(parts_);
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
  const py::object result = parts_.dynamics(x, u);
  if (!py::isinstance<py::array>(result))
    throw py::type_error("Problem.dynamics: returned " + py::repr(py::type::of(result)).cast<std::string>() +
                         ", must be an array");
  auto array = py::reinterpret_borrow<py::array>(result);
  if (array.ndim() != 2 || array.shape(0) != x.shape(0) || array.shape(1) != parts_.states)
    throw py::value_error("Problem.dynamics: returned shape " + shape_text(array) + ", must be " +
                          shape_text(x));
  return array;
}

template <class Real>
void CallableProblem::add_cost(const char* what, const py::object& result, py::ssize_t count, Real* costs,
                               std::uint8_t* collided, Prediction* prediction) const {
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
  if (py::isinstance<py::dict>(values)) {
    for (const auto& [name, term] : py::reinterpret_borrow<py::dict>(values)) {
      const Real before = costs[0];
      add_values_of(what, py::reinterpret_borrow<py::object>(term), count, costs);
      if (prediction) prediction->add(py::str(name), static_cast<double>(costs[0] - before));
    }
    return;
  }
  const Real before = costs[0];
  add_values_of(what, values, count, costs);
  if (prediction)
    prediction->add(std::string_view(what) == "terminal_cost" ? "terminal" : "stage",
                    static_cast<double>(costs[0] - before));
}

template <class Real>
void CallableProblem::add_values_of(const char* what, const py::object& values, py::ssize_t count,
                                    Real* costs) const {
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

/// Moves the inputs of all samples, `held` [input][sample], towards those of step `k`, no faster than
/// allowed.
void CallableProblem::hold_step(const SequenceBatch& batch, int k, int first, int count,
                                std::vector<float>& held) const {
  float* before = held.data();
  for (int i = 0; i < parts_.inputs; ++i) {
    const float reach = static_cast<float>(entry(parts_.input_rate_max, i, 0) * parts_.dt);
    const float* wanted = batch.row(k, i) + first;
    for (int s = 0; s < count; ++s, ++before)
      *before = std::min(std::max(wanted[s], *before - reach), *before + reach);
  }
}

void CallableProblem::draw(SequenceBatch& noise, int first, int count, RandomKey key) const {
  const auto random = py::module_::import("numpy").attr("random").attr("default_rng")(
      py::make_tuple(key.seed, key.stream, first));
  const auto array = py::array_t<float, py::array::forcecast>::ensure(
      parts_.sampler(random, count, noise.steps(), noise.inputs()));
  if (!array) throw py::error_already_set();
  if (array.ndim() != 3 || array.shape(0) != count || array.shape(1) != noise.steps() ||
      array.shape(2) != noise.inputs())
    throw py::value_error("Problem.sampler: returned shape " + shape_text(array) + ", must be (" +
                          std::to_string(count) + ", " + std::to_string(noise.steps()) + ", " +
                          std::to_string(noise.inputs()) + ")");
  const auto values = array.unchecked<3>();
  for (int k = 0; k < noise.steps(); ++k)
    for (int i = 0; i < noise.inputs(); ++i)
      for (int s = 0; s < count; ++s) noise.row(k, i)[first + s] = values(s, k, i);
}

void CallableProblem::fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept {
  const py::gil_scoped_acquire lock;
  try {
    if (!error_) return draw(noise, first, count, key);
  } catch (...) {
    error_ = std::current_exception();
  }
  fill_normal(noise, first, count, key);
}

void CallableProblem::roll_out(const SequenceBatch& batch, int first, int count, float* costs,
                               std::uint8_t* collided) const {
  // Columns lie together in memory, as the inputs do, so that the callables work on contiguous columns.
  constexpr py::ssize_t width = sizeof(float);
  py::array x(py::dtype::of<float>(), {py::ssize_t{count}, py::ssize_t{parts_.states}},
              {width, width * count});
  float* values = static_cast<float*>(x.mutable_data());
  for (const float value : state_) values = std::fill_n(values, count, value);
  std::fill_n(costs, count, 0.0f);
  std::fill_n(collided, count, std::uint8_t{0});
  const bool holds = !parts_.input_rate_max.empty();
  std::vector<float> held;
  for (const float value : previous_)
    held.insert(held.end(), holds ? static_cast<std::size_t>(count) : 0, value);
  for (int k = 0; k < batch.steps(); ++k) {
    if (holds) hold_step(batch, k, first, count, held);
    const float* const from = holds ? held.data() : batch.row(k, 0) + first;
    py::array u(py::dtype::of<float>(), {py::ssize_t{count}, py::ssize_t{parts_.inputs}},
                {width, width * (holds ? count : batch.stride())}, from, owner_);
    read_only(u);
    add_cost("cost", parts_.cost(x, u), count, costs, collided);
    x = next(x, u);
  }
  if (!parts_.terminal_cost.is_none())
    add_cost("terminal_cost", parts_.terminal_cost(x), count, costs, collided);
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

namespace {
/// Values as the only row of an array.
py::array_t<double> row(std::span<const double> values) {
  return py::array_t<double>({py::ssize_t{1}, static_cast<py::ssize_t>(values.size())}, values.data());
}
}  // namespace

std::vector<double> CallableProblem::step(std::span<const double> state, std::span<const double> input) {
  const auto result =
      py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(next(row(state), row(input)));
  return {result.data(), result.data() + parts_.states};
}

Prediction CallableProblem::predict(std::span<const double> state, std::span<const double> inputs) {
  std::vector<double> now(state.begin(), state.end());
  Prediction result{now, 0, false, {}};
  std::uint8_t collided = 0;
  const auto nu = static_cast<std::size_t>(parts_.inputs);
  for (; !inputs.empty(); inputs = inputs.subspan(nu)) {
    const auto input = inputs.first(nu);
    add_cost("cost", parts_.cost(row(now), row(input)), 1, &result.cost, &collided, &result);
    now = step(now, input);
    result.states.insert(result.states.end(), now.begin(), now.end());
  }
  if (!parts_.terminal_cost.is_none())
    add_cost("terminal_cost", parts_.terminal_cost(row(now)), 1, &result.cost, &collided, &result);
  result.collided = collided != 0;
  return result;
}

}  // namespace slalom::python
