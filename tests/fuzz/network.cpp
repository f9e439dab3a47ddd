// Networks in .npz files. A fuzzer does not find the checksums of an archive; so the input is read as an
// archive, and again as the arrays of one, whose checksums are right.
#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/network/mlp.hpp"
#include "support/npz_writer.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  const testing::NpzArrays network = testing::network_files();
  std::string arrays;
  for (const auto& [name, data] : network) arrays += (arrays.empty() ? "" : std::string(1, separator)) + data;
  return {testing::zip(network), arrays};
}

bool read(const std::string& archive) {
  try {
    const MlpParameters parameters = load_mlp(scratch_file("network.npz", archive));
    require(!parameters.layers.empty(), "a network has layers");
    for (const MlpParameters::Layer& layer : parameters.layers) {
      require(layer.weights.size() ==
                      static_cast<std::size_t>(layer.inputs) * static_cast<std::size_t>(layer.outputs) &&
                  layer.biases.size() == static_cast<std::size_t>(layer.outputs),
              "a layer has its weights and biases");
      for (const auto* values : {&layer.weights, &layer.biases})
        for (const double value : *values) require(std::isfinite(value), "weights are finite");
    }
    const int inputs = parameters.layers.front().inputs, outputs = parameters.layers.back().outputs;
    try {
      const detail::MlpNetwork network(parameters, inputs, outputs);
      if (inputs > detail::MlpNetwork::max_neurons) return true;
      double values[detail::MlpNetwork::max_neurons] = {}, other[detail::MlpNetwork::max_neurons] = {};
      network.evaluate(values, other);
    } catch (const std::invalid_argument&) {
      // The file is valid; with its normalisation a weight is no finite float32.
    }
    return true;
  } catch (const IoError&) {
    return false;
  }
}

bool run(std::string_view bytes) {
  const bool archive = read(std::string(bytes));
  testing::NpzArrays network = testing::network_files();
  const auto arrays = split<7>(bytes);
  for (std::size_t i = 0; i < arrays.size(); ++i)
    if (!arrays[i].empty()) network[i].second = arrays[i];
  return read(testing::zip(network)) || archive;
}

const Target target("network", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
