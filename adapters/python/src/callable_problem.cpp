#include "callable_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slalom::python {
namespace {

/// Batches of at most this number of samples take longer to call a function than to compute.
constexpr int small_batch = 512;

/// An array [rows, columns] of zeros whose columns are contiguous, as callables work on columns.
py::array_t<float> columns(py::ssize_t rows, py::ssize_t count) {
  constexpr py::ssize_t width = sizeof(float);
  py::array_t<float> values({rows, count}, {width, width * rows});
  std::fill_n(values.mutable_data(), rows * count, 0.0f);
  return values;
}

/// The same without zeros, in memory that is used again if nobody keeps it: new one is cleared by the system.
py::array_t<float> room(py::array_t<float>& kept, py::ssize_t rows, py::ssize_t count) {
  constexpr py::ssize_t width = sizeof(float);
  if (kept.ref_count() > 1 || kept.size() < rows * count) kept = py::array_t<float>(rows * count);
  return {{rows, count}, {width, width * rows}, kept.data(), kept};
}

/// Copies the columns of an array [count, columns] to places that are `stride` apart.
void copy_columns(const py::array& from, py::ssize_t count, float* to, py::ssize_t stride) {
  const bool contiguous = py::isinstance<py::array_t<float>>(from) && from.strides(0) == sizeof(float);
  for (py::ssize_t i = 0; i < from.shape(1); ++i, to += stride) {
    std::fill_n(to, contiguous ? 0 : count, 0.0f);
    if (!contiguous) add_column(from, i, count, to);
    if (contiguous) std::memcpy(to, from.data(0, i), sizeof(float) * static_cast<std::size_t>(count));
  }
}

/// Values as the only row of an array.
py::array_t<double> row(std::span<const double> values) {
  return py::array_t<double>({py::ssize_t{1}, static_cast<py::ssize_t>(values.size())}, values.data());
}

bool takes_k(const py::object& callable) {
  return py::module_::import("slalom.display").attr("takes_k")(callable).cast<bool>();
}

/// Calls a function of a step, with its index `k` if the function takes it. It must not write `x` and `u`.
py::object call_step(const py::object& function, const py::array& x, const py::array& u, bool with_k, int k) {
  return with_k ? function(lent(x), lent(u), k) : function(lent(x), lent(u));
}

/// Adds a cost that a callable returned to `costs` [count] and its terms to `prediction`, if that is given.
template <class Real>
void add_cost(const char* what, const py::object& result, py::ssize_t count, Real* costs,
              std::uint8_t* collided, Prediction* prediction = nullptr) {
  visit_terms(what, result, count, collided, [&](const std::string& name, const py::array& values) {
    const Real before = costs[0];
    add_column(values, 0, count, costs);
    if (prediction) prediction->add(name, static_cast<double>(costs[0] - before));
  });
}

}  // namespace

CallableProblem::CallableProblem(CallableParts parts)
    : parts_(std::move(parts)),
      state_(static_cast<std::size_t>(std::max(parts_.states, 0))),
      previous_(static_cast<std::size_t>(std::max(parts_.inputs, 0))) {
  check_parts();
  dynamics_take_k_ = takes_k(parts_.dynamics);
  cost_takes_k_ = takes_k(parts_.cost);
  set_dt(parts_.dt);
}

void CallableProblem::check_parts() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("Problem." + what);
  };
  const bool whole = !parts_.rollout.is_none();
  const auto require_callable = [&](const py::object& part, const std::string& name, bool optional) {
    require(PyCallable_Check(part.ptr()) || (optional && part.is_none()),
            name + ": must be callable" + (optional ? " or None" : ""));
  };
  require_callable(parts_.dynamics, "dynamics", whole);
  require_callable(parts_.cost, "cost", whole);
  require_callable(parts_.terminal_cost, "terminal_cost", true);
  require_callable(parts_.sampler, "sampler", true);
  require_callable(parts_.rollout, "rollout", true);
  require(!whole || (parts_.dynamics.is_none() && parts_.cost.is_none() && parts_.terminal_cost.is_none()),
          "rollout: takes the place of dynamics, cost and terminal_cost, which must not be given");
  const int states = parts_.states, inputs = parts_.inputs;
  require(states >= 1 && states <= 10000, "states: " + std::to_string(states) + " must be in [1, 10000]");
  require(inputs >= 1 && inputs <= 10000, "inputs: " + std::to_string(inputs) + " must be in [1, 10000]");
  const auto require_count = [&](const std::vector<double>& values, const std::string& what) {
    require(values.size() <= 1 || static_cast<int>(values.size()) == inputs,
            what + ": has " + std::to_string(values.size()) + " values, must have " + one_or(inputs));
  };
  require_count(parts_.input_min, "input_min");
  require_count(parts_.input_max, "input_max");
  require_count(parts_.input_rate_max, "input_rate_max");
  require_count(parts_.input_levels, "input_levels");
  for (const double rate : parts_.input_rate_max)
    require(rate >= 0, "input_rate_max: " + to_text(rate) + " must be at least 0");
  if (!in_levels()) return;
  require(!parts_.input_min.empty() && !parts_.input_max.empty() && parts_.input_rate_max.empty(),
          "input_levels: needs input_min and input_max, and no input_rate_max");
  for (int i = 0; i < inputs; ++i) slalom::detail::stated_bounds(levels_of(i));
}

double CallableProblem::input_step(int input) const noexcept {
  return parts_.input_rate_max.empty() ? AnyProblem::input_step(input)
                                       : value_for(parts_.input_rate_max, input, 0) * parts_.dt;
}
void CallableProblem::set_previous_input(std::span<const double> u) noexcept {
  previous_.assign(u.begin(), u.end());
}

/// Holds values of an input within its rate, or in levels, each with what the step before has carried.
template <class T>
void CallableProblem::hold(int input, std::span<T> values, std::span<T> carried) const noexcept {
  using One = Input<T, 1>;
  const auto levels = slalom::detail::levels_of<T>(levels_of(input));
  const One reach{{static_cast<T>(input_step(input))}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    One now{{values[i]}}, before{{carried[i]}};
    in_levels() ? slalom::detail::hold_levels(now, before, levels)
                : slalom::detail::hold_rate(now, before, reach);
    values[i] = now[0];
    carried[i] = before[0];
  }
}

void CallableProblem::hold_rates(std::span<const double> previous, std::span<double> u) const noexcept {
  if (!holds()) return;
  std::array<double, 1> carried;
  for (int i = 0; i < parts_.inputs; ++i) {
    carried[0] = previous[static_cast<std::size_t>(i)];
    for (auto at = static_cast<std::size_t>(i); at < u.size(); at += previous.size())
      hold<double>(i, u.subspan(at, 1), carried);
  }
}

void CallableProblem::carry(std::span<const float> wanted, std::span<const double> held,
                            std::span<double> remainder) const noexcept {
  for (std::size_t at = 0; at < held.size(); ++at) {
    const std::size_t i = at % remainder.size();
    const double half = slalom::detail::levels_of<double>(levels_of(static_cast<int>(i))).spacing[0] / 2;
    remainder[i] = std::clamp(remainder[i] + static_cast<double>(wanted[at]) - held[at], -half, half);
  }
}

/// The sequences of a batch within rates or in levels, [step][input][sample]; none without such limits.
std::vector<float> CallableProblem::held_sequences(const SequenceBatch& batch, int first, int count) const {
  std::vector<float> all;
  if (!holds()) return all;
  const auto samples = static_cast<std::size_t>(count);
  std::vector<float> carried;
  for (const float value : previous_) carried.insert(carried.end(), samples, value);
  for (int k = 0; k < batch.steps(); ++k) {
    for (int i = 0; i < parts_.inputs; ++i) {
      const float* const wanted = batch.row(k, i) + first;
      all.insert(all.end(), wanted, wanted + count);
      hold<float>(i, std::span(all).last(samples),
                  std::span(carried).subspan(static_cast<std::size_t>(i) * samples, samples));
    }
  }
  return all;
}

void CallableProblem::set_dt(double dt) {
  if (!(dt >= 0 && std::isfinite(dt)))
    throw std::invalid_argument("Problem.dt: " + to_text(dt) +
                                " must be finite and at least 0 (0: not known)");
  if (dt == 0 && !parts_.input_rate_max.empty())
    throw std::invalid_argument("Problem.dt: must be positive, since input_rate_max is set");
  parts_.dt = dt;
}

std::unique_ptr<AnyProblem> CallableProblem::clone() const {
  return std::make_unique<CallableProblem>(parts_);
}

void CallableProblem::set_state(std::span<const double> state) noexcept {
  state_.assign(state.begin(), state.end());
}

void CallableProblem::begin(void* owner) {
  owner_ = static_cast<PyObject*>(owner);
  error_ = nullptr;
}

void CallableProblem::finish() {
  owner_ = {};
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

py::object CallableProblem::stage_cost(const py::array& x, const py::array& u, int k) const {
  return call_step(parts_.cost, x, u, cost_takes_k_, k);
}

py::array CallableProblem::next(const py::array& x, const py::array& u, int k) const {
  return array_of("dynamics", call_step(parts_.dynamics, x, u, dynamics_take_k_, k),
                  {x.shape(0), parts_.states});
}

void CallableProblem::draw(SequenceBatch& noise, int first, int count, RandomKey key) const {
  const auto random = py::module_::import("numpy").attr("random").attr("default_rng")(
      py::make_tuple(key.seed, key.stream, first));
  const py::array_t<float, py::array::forcecast> array(
      parts_.sampler(random, count, noise.steps(), noise.inputs()));
  check_shape("sampler", array, {count, noise.steps(), noise.inputs()});
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
  std::fill_n(costs, count, 0.0f);
  std::fill_n(collided, count, std::uint8_t{0});
  const std::vector<float> held = held_sequences(batch, first, count);
  const float* const sequences = held.empty() ? batch.row(0, 0) + first : held.data();
  constexpr py::ssize_t width = sizeof(float);
  const py::ssize_t row = width * (held.empty() ? batch.stride() : count), step = row * parts_.inputs;
  const auto lent_inputs = [&](const float* from, std::vector<py::ssize_t> shape,
                               std::vector<py::ssize_t> strides) {
    return py::array(py::dtype::of<float>(), std::move(shape), std::move(strides), from, owner_);
  };
  if (!parts_.rollout.is_none()) {
    const py::array u = lent_inputs(sequences, {count, batch.steps(), parts_.inputs}, {width, step, row});
    return add_column(outcome_of(array_of(state_), u).costs, 0, count, costs);
  }
  py::array x = columns(count, parts_.states);
  float* values = static_cast<float*>(x.mutable_data());
  for (const double value : state_) values = std::fill_n(values, count, static_cast<float>(value));
  // The costs of a small batch are computed for all steps in one call.
  const bool together = count <= small_batch && !cost_takes_k_;
  const py::ssize_t rows = together ? py::ssize_t{count} * batch.steps() : 0;
  py::array_t<float> all_x = room(all_x_, rows, parts_.states), all_u = room(all_u_, rows, parts_.inputs);
  for (int k = 0; k < batch.steps(); ++k) {
    const py::array u = lent_inputs(sequences + k * (step / width), {count, parts_.inputs}, {width, row});
    if (together) {
      copy_columns(x, count, all_x.mutable_data() + py::ssize_t{k} * count, rows);
      copy_columns(u, count, all_u.mutable_data() + py::ssize_t{k} * count, rows);
    } else {
      add_cost("cost", stage_cost(x, u, k), count, costs, collided);
    }
    x = next(x, u, k);
  }
  if (together) {
    const auto size = static_cast<std::size_t>(rows);
    std::vector<float> stage(size);
    std::vector<std::uint8_t> hit(size);
    add_cost("cost", stage_cost(all_x, all_u, 0), rows, stage.data(), hit.data());
    for (std::size_t i = 0; i < size; ++i) {
      costs[i % static_cast<std::size_t>(count)] += stage[i];
      collided[i % static_cast<std::size_t>(count)] |= hit[i];
    }
  }
  if (!parts_.terminal_cost.is_none()) add_cost("terminal_cost", terminal_cost(x), count, costs, collided);
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
std::vector<double> CallableProblem::step(std::span<const double> state, std::span<const double> input,
                                          int k) {
  if (!parts_.rollout.is_none()) {
    const Prediction found = roll_out_alone(state, input);
    return {found.known_states().end() - parts_.states, found.states.end()};
  }
  const Numbers result(next(row(state), row(input), k));
  return {result.data(), result.data() + parts_.states};
}

/// Calls the rollout of all sequences u [K, steps, inputs] from a state.
CallableProblem::Outcome CallableProblem::outcome_of(const py::array& state, const py::array& u) const {
  py::object costs = parts_.rollout(lent(state), lent(u)), states = py::none();
  if (py::isinstance<py::tuple>(costs) && py::len(costs) == 2)
    std::tie(costs, states) = costs.cast<std::pair<py::object, py::object>>();
  Outcome outcome{array_of("rollout", costs, {u.shape(0)}), Numbers(0)};
  if (!states.is_none())
    outcome.states = array_of("rollout: states", states, {u.shape(0), u.shape(1) + 1, parts_.states});
  return outcome;
}

/// The rollout of one sequence.
Prediction CallableProblem::roll_out_alone(std::span<const double> state,
                                           std::span<const double> inputs) const {
  Prediction result{{state.begin(), state.end()}, 0, false, {}};
  if (inputs.empty()) return result;
  const py::ssize_t width = parts_.inputs, steps = static_cast<py::ssize_t>(inputs.size()) / width;
  const Outcome outcome =
      outcome_of(array_of(state), py::array_t<double>({py::ssize_t{1}, steps, width}, inputs.data()));
  add_column(outcome.costs, 0, 1, &result.cost);
  result.add("total", result.cost);
  const Numbers states(outcome.states);
  result.states.assign(states.data(),
                       states.data() + states.size());  // none if the rollout tells costs alone
  return result;
}

Prediction CallableProblem::predict(std::span<const double> state, std::span<const double> inputs) {
  if (!parts_.rollout.is_none()) return roll_out_alone(state, inputs);
  std::vector<double> now(state.begin(), state.end());
  Prediction result{now, 0, false, {}};
  std::uint8_t collided = 0;
  const auto nu = static_cast<std::size_t>(parts_.inputs);
  for (int k = 0; !inputs.empty(); inputs = inputs.subspan(nu), ++k) {
    const auto input = inputs.first(nu);
    add_cost("cost", stage_cost(row(now), row(input), k), 1, &result.cost, &collided, &result);
    now = step(now, input, k);
    result.states.insert(result.states.end(), now.begin(), now.end());
  }
  if (!parts_.terminal_cost.is_none())
    add_cost("terminal_cost", terminal_cost(row(now)), 1, &result.cost, &collided, &result);
  result.collided = collided != 0;
  return result;
}
}  // namespace slalom::python
