#include "network_problem.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/option_access.hpp"

namespace slalom::python {

namespace {

/// Makes `values` one for each of `count`: none is 0 for all, and one value holds for all.
void spread(std::vector<double>& values, int count, const char* name) {
  if (values.empty()) values.push_back(0);
  if (values.size() == 1) values.resize(static_cast<std::size_t>(count), values[0]);
  if (static_cast<int>(values.size()) != count)
    throw std::invalid_argument(std::string("MlpProblem.") + name + ": has " + std::to_string(values.size()) +
                                " values, must have " + one_or(count));
  for (const double value : values)
    if (!std::isfinite(value))
      throw std::invalid_argument(std::string("MlpProblem.") + name + ": must be finite");
}

/// The parameters of a network, from a slalom.mlp.Mlp.
MlpParameters parameters_of(const py::object& network) {
  const auto values = [](const py::object& array, py::ssize_t dimensions) {
    const auto numbers = Numbers::ensure(array);
    if (!numbers || numbers.ndim() != dimensions)
      throw std::invalid_argument("MlpProblem.network: an array has a wrong number of dimensions");
    return std::vector<double>(numbers.data(), numbers.data() + numbers.size());
  };
  if (!py::hasattr(network, "layers") || !py::hasattr(network, "activation"))
    throw py::type_error("MlpProblem.network: " + py::repr(network).cast<std::string>() +
                         " must be a slalom.mlp.Mlp");
  MlpParameters p;
  for (const py::handle& layer : network.attr("layers")) {
    const auto pair = layer.cast<std::pair<py::array, py::object>>();
    MlpParameters::Layer made{0, 0, values(pair.first, 2), values(pair.second, 1)};
    made.outputs = static_cast<int>(pair.first.shape(0));
    made.inputs = static_cast<int>(pair.first.shape(1));
    p.layers.push_back(std::move(made));
  }
  p.activation = activation_of(network.attr("activation").cast<std::string>());
  p.input_mean = values(network.attr("input_mean"), 1);
  p.input_scale = values(network.attr("input_scale"), 1);
  p.output_mean = values(network.attr("output_mean"), 1);
  p.output_scale = values(network.attr("output_scale"), 1);
  p.residual = network.attr("residual").cast<bool>();
  return p;
}

}  // namespace

NetworkProblem::NetworkProblem(Parts parts) : parts_(std::move(parts)) {
  NetworkModel& m = parts_.model;
  const MlpParameters p = parameters_of(parts_.network);
  const int entering = p.layers.empty() ? 0 : p.layers.front().inputs;
  m.states = p.layers.empty() ? 0 : p.layers.back().outputs;
  m.inputs = entering - m.states;
  if (m.states < 1 || m.inputs < 1 || entering > most)
    throw std::invalid_argument(
        "MlpProblem.network: maps " + std::to_string(entering) + " values to " + std::to_string(m.states) +
        ", must map a state and the inputs of a step, at most 64 values, to the next state");
  m.network = slalom::detail::MlpNetwork(p, entering, m.states);
  m.residual = p.residual;
  spread(m.goal, m.states, "goal");
  spread(m.state_weights, m.states, "state_weights");
  spread(m.terminal_weights, m.states, "terminal_weights");
  spread(m.input_weights, m.inputs, "input_weights");
  m.has_walls = !parts_.walls.is_none();
  if (m.has_walls) m.walls = parts_.walls.cast<maps::Field>();
  m.has_field = !parts_.field.is_none();
  if (m.has_field) m.field = parts_.field.cast<maps::Field>();
  if ((!m.discs.empty() || m.has_walls || m.has_field) && m.states < 2)
    throw std::invalid_argument(
        "MlpProblem: discs, walls and field need a state of at least 2 values, x and y first");
  for (std::vector<double>* bound : {&m.input_min, &m.input_max})
    if (bound->size() > 1) spread(*bound, m.inputs, "input_min, input_max");
  if (!(m.dt >= 0 && std::isfinite(m.dt)))
    throw std::invalid_argument("MlpProblem.dt: " + to_text(m.dt) +
                                " must be finite and at least 0 (0: not known)");
  state_.resize(static_cast<std::size_t>(m.states));
}

void NetworkProblem::set_state(std::span<const double> state) noexcept {
  state_.assign(state.begin(), state.end());
}

std::vector<double> NetworkProblem::step(std::span<const double> state, std::span<const double> input, int) {
  std::vector<double> x(state.begin(), state.end());
  take_step(parts_.model, input.data(), x.data());
  return x;
}

Prediction NetworkProblem::predict(std::span<const double> state, std::span<const double> inputs) {
  const NetworkModel& m = parts_.model;
  std::vector<double> x(state.begin(), state.end());
  Prediction result{x, 0, false, {}};
  const auto add = [&](const char* name, double value) {
    result.cost += value;
    result.add(name, value);
  };
  const auto nu = static_cast<std::size_t>(m.inputs);
  for (;; inputs = inputs.subspan(nu)) {
    const bool last = inputs.empty();
    const auto cost = state_cost(m, last ? m.terminal_weights : m.state_weights, x.data());
    add(last ? "terminal" : "state", cost.distance);
    add("obstacles", cost.obstacles);
    add("field", cost.field);
    result.collided = result.collided || cost.collided;
    if (last) return result;
    add("input", input_cost(m, inputs.data()));
    take_step(m, inputs.data(), x.data());
    result.states.insert(result.states.end(), x.begin(), x.end());
  }
}

void NetworkProblem::evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                              std::uint8_t* collided) const noexcept {
  roll_out_network(parts_.model, state_.data(), batch, first, count, costs, collided);
}

}  // namespace slalom::python
