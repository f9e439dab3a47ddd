#include "slalom/core/network/mlp.hpp"

#include <limits>

#include "slalom/core/error.hpp"
#include "slalom/core/network/npz.hpp"

namespace slalom {
namespace {

[[noreturn]] void reject(const std::string& what) {
  throw std::invalid_argument("mlp: " + what);
}

void check_values(const std::vector<double>& values, std::size_t count, const std::string& name) {
  if (values.size() != count)
    reject(name + ": has " + std::to_string(values.size()) + " values, must have " + std::to_string(count));
  for (const double v : values)
    if (!(std::abs(v) <= std::numeric_limits<float>::max()))
      reject(name + ": every value must be a finite float32");
}

void check_scale(const std::vector<double>& values, int count, const std::string& name) {
  if (values.empty()) return;
  check_values(values, static_cast<std::size_t>(count), name);
  for (const double v : values)
    if (name == "input_scale" && !(std::abs(v) >= 1e-30)) reject(name + ": no value may be 0");
}

void check(const MlpParameters& p, int inputs, int outputs) {
  using detail::MlpNetwork;
  if (p.layers.empty() || p.layers.size() > MlpNetwork::max_layers)
    reject("has " + std::to_string(p.layers.size()) + " layers, must have 1 to " +
           std::to_string(MlpNetwork::max_layers));
  int entering = inputs;
  for (std::size_t i = 0; i < p.layers.size(); ++i) {
    const auto& layer = p.layers[i];
    const std::string name = "weights_" + std::to_string(i);
    if (layer.inputs != entering)
      reject(name + ": has " + std::to_string(layer.inputs) + " columns, must have " +
             std::to_string(entering) + (i == 0 ? ", the inputs" : ", the rows of the layer before"));
    if (layer.outputs < 1 || layer.outputs > MlpNetwork::max_neurons)
      reject(name + ": has " + std::to_string(layer.outputs) + " rows, must have 1 to " +
             std::to_string(MlpNetwork::max_neurons));
    const auto rows = static_cast<std::size_t>(layer.outputs);
    check_values(layer.weights, rows * static_cast<std::size_t>(layer.inputs), name);
    check_values(layer.biases, rows, "biases_" + std::to_string(i));
    entering = layer.outputs;
  }
  if (entering != outputs)
    reject("the last layer has " + std::to_string(entering) + " rows, must have " + std::to_string(outputs) +
           ", the outputs");
  check_scale(p.input_mean, inputs, "input_mean");
  check_scale(p.input_scale, inputs, "input_scale");
  check_scale(p.output_mean, outputs, "output_mean");
  check_scale(p.output_scale, outputs, "output_scale");
  if (p.residual && outputs > inputs) reject("residual: needs at least as many inputs as outputs");
}

double entry(const std::vector<double>& values, int index, double otherwise) {
  return values.empty() ? otherwise : values[index];
}

/// The layers with the normalisation of inputs and outputs in the first and the last one.
std::vector<MlpParameters::Layer> with_normalisation(const MlpParameters& p) {
  auto layers = p.layers;
  const auto weight = [](MlpParameters::Layer& l, int row, int column) -> double& {
    return l.weights[static_cast<std::size_t>(row) * static_cast<std::size_t>(l.inputs) +
                     static_cast<std::size_t>(column)];
  };
  auto& first = layers.front();
  for (int row = 0; row < first.outputs; ++row) {
    for (int column = 0; column < first.inputs; ++column) {
      double& w = weight(first, row, column);
      w /= entry(p.input_scale, column, 1);
      first.biases[row] -= w * entry(p.input_mean, column, 0);
    }
  }
  auto& last = layers.back();
  for (int row = 0; row < last.outputs; ++row) {
    const double scale = entry(p.output_scale, row, 1);
    for (int column = 0; column < last.inputs; ++column) weight(last, row, column) *= scale;
    double& bias = last.biases[row];
    bias = bias * scale + entry(p.output_mean, row, 0);
  }
  return layers;
}

}  // namespace

namespace detail {

MlpNetwork::MlpNetwork(int inputs, int outputs) {
  MlpParameters zero;
  const auto weights = static_cast<std::size_t>(inputs) * static_cast<std::size_t>(outputs);
  zero.layers.push_back({inputs, outputs, std::vector<double>(weights),
                         std::vector<double>(static_cast<std::size_t>(outputs))});
  *this = MlpNetwork(zero, inputs, outputs);
}

MlpNetwork::MlpNetwork(const MlpParameters& parameters, int inputs, int outputs)
    : activation_(parameters.activation) {
  check(parameters, inputs, outputs);
  std::vector<float> weights;
  const auto layers = with_normalisation(parameters);
  layers_ = static_cast<int>(layers.size());
  sizes_[0] = inputs;
  for (int i = 0; i < layers_; ++i) {
    const auto& layer = layers[i];
    sizes_[i + 1] = layer.outputs;
    store(layer, weights);
  }
  std::shared_ptr<float[]> copy(new float[weights.size()]);
  std::copy(weights.begin(), weights.end(), copy.get());
  weights_ = std::move(copy);
}

/// Blocks of neurons: their biases, then for each input their weights; neurons that fill up a block are 0.
void MlpNetwork::store(const MlpParameters::Layer& layer, std::vector<float>& weights) {
  for (int first = 0; first < layer.outputs; first += block) {
    for (int column = -1; column < layer.inputs; ++column) {
      for (int row = first; row < first + block; ++row) {
        const auto r = static_cast<std::size_t>(row);
        const double value =
            row >= layer.outputs ? 0
            : column < 0
                ? layer.biases[r]
                : layer
                      .weights[r * static_cast<std::size_t>(layer.inputs) + static_cast<std::size_t>(column)];
        if (!(std::abs(value) <= std::numeric_limits<float>::max()))
          reject("with its normalisation, a weight is not a finite float32");
        weights.push_back(static_cast<float>(value));
      }
    }
  }
}

}  // namespace detail

Activation activation_of(std::string_view name) {
  const char* const* const names = enum_names(Activation{});
  for (int i = 0; names[i]; ++i)
    if (name == names[i]) return static_cast<Activation>(i);
  throw std::invalid_argument("'" + std::string(name) + "' must be tanh, relu, softplus or silu");
}

MlpParameters load_mlp(const std::filesystem::path& npz_file) {
  auto arrays = read_npz(npz_file);
  const auto fail = [&](const std::string& what) { throw IoError(npz_file.string(), 0, what); };
  const auto take = [&](const std::string& name, std::size_t dimensions, bool required) {
    NpyArray array;
    const auto found = arrays.find(name);
    if (found == arrays.end()) {
      if (required) fail("array '" + name + "' is missing");
      return array;
    }
    array = std::move(found->second);
    arrays.erase(found);
    if (array.shape.size() != dimensions)
      fail("array '" + name + "': has " + std::to_string(array.shape.size()) + " dimensions, must have " +
           std::to_string(dimensions));
    return array;
  };
  MlpParameters p;
  for (int i = 0; i == 0 || arrays.contains("weights_" + std::to_string(i)); ++i) {
    const NpyArray weights = take("weights_" + std::to_string(i), 2, true),
                   biases = take("biases_" + std::to_string(i), 1, true);
    p.layers.push_back({static_cast<int>(weights.shape[1]), static_cast<int>(weights.shape[0]),
                        weights.values, biases.values});
  }
  const std::string activation = take("activation", 0, true).text;
  try {
    p.activation = activation_of(activation);
  } catch (const std::invalid_argument& error) {
    fail(std::string("array 'activation': ") + error.what());
  }
  p.input_mean = take("input_mean", 1, false).values;
  p.input_scale = take("input_scale", 1, false).values;
  p.output_mean = take("output_mean", 1, false).values;
  p.output_scale = take("output_scale", 1, false).values;
  const NpyArray residual = take("residual", 0, false);
  p.residual = !residual.values.empty() && residual.values[0] != 0;
  if (!arrays.empty()) fail("array '" + arrays.begin()->first + "' is not known");
  try {
    check(p, p.layers.front().inputs, p.layers.back().outputs);
  } catch (const std::invalid_argument& error) {
    fail(error.what());
  }
  return p;
}

}  // namespace slalom
