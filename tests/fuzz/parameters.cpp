// Configuration files, options as `--set key=value` and the page give them (one a line), and networks in .npz
// files. A fuzzer does not find the checksums of an archive; so the input is read as an archive, and again as
// the arrays of one, whose checksums are right.
#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/network/mlp.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "support/npz_writer.hpp"
#include "tools/command_line/command.hpp"
#include "tools/scenario/scenario.hpp"

namespace slalom::fuzz {
namespace {

const Target configuration_target(
    "configuration", 8192,
    []() -> Seeds {
      return {vehicle::to_yaml({}),
              "base: other\nsvg_mppi:\n  samples: 4000\n  variance: [0.1]\nplanner:\n  max_speed: "
              "6\nvehicle:\n  model: kinematic\n",
              "mppi: {temperature: 0.5, input_min: -.inf}\nplanner: {stop_when_blocked: true}\n"};
    },
    [](std::string_view bytes) {
      static const std::string other = scratch_file("other.yaml", "mppi:\n  samples: 100\n");
      const auto configuration =
          vehicle::load_configuration(scratch_file("configuration.yaml", bytes), {scratch_folder().path()});
      const std::string text = vehicle::to_yaml(configuration);
      require(vehicle::to_yaml(vehicle::load_configuration(scratch_file("again.yaml", text))) == text,
              "a configuration that is written reads back as the same");
      return true;
    });

/// The values of all options are within their declared ranges.
void check_ranges(const vehicle::Configuration& configuration) {
  for (const vehicle::Section& section : vehicle::list_sections(configuration))
    for (const OptionEntry& option : section.options) {
      const auto check = [&](double value) {
        require(
            value >= option.declaration.min && value <= option.declaration.max,
            section.name + "." + option.declaration.name + ": " + to_text(option.value) + " is out of range");
      };
      if (const auto* integer = std::get_if<int>(&option.value)) check(*integer);
      if (const auto* number = std::get_if<double>(&option.value)) check(*number);
      if (const auto* numbers = std::get_if<std::vector<double>>(&option.value))
        for (const double number : *numbers) check(number);
    }
}

const Target options_target(
    "options", 4096,
    []() -> Seeds {
      Seeds seeds{"samples=100\nsvg_mppi.variance=[0.1]\nworld.friction=0.5\nplanner.max_speed=8\n"};
      for (const vehicle::Section& section : vehicle::list_sections({})) {
        std::string all;
        for (const OptionEntry& option : section.options)
          all += section.name + "." + option.declaration.name + "=" + to_text(option.value) + "\n";
        seeds.push_back(all);
      }
      return seeds;
    },
    [](std::string_view bytes) {
      bool valid = true;
      vehicle::Configuration configuration;
      evaluation::LapSettings lap;
      while (!bytes.empty()) {
        const std::string_view line = bytes.substr(0, bytes.find('\n'));
        bytes.remove_prefix(std::min(bytes.size(), line.size() + 1));
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos) continue;
        try {
          tools::apply_setting(std::string(line.substr(0, equals)), std::string(line.substr(equals + 1)),
                               "svg_mppi", configuration, lap);
        } catch (const tools::CommandLineError&) {
          valid = false;
        }
      }
      check_ranges(configuration);
      validate_options(lap, "world");
      return valid;
    });

/// Reads a network and evaluates it. Throws IoError.
void read_network(const std::string& archive) {
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
    if (inputs > detail::MlpNetwork::max_neurons) return;
    double values[detail::MlpNetwork::max_neurons] = {}, other[detail::MlpNetwork::max_neurons] = {};
    network.evaluate(values, other);
  } catch (const std::invalid_argument&) {
    // The file is valid; with its normalisation a weight is no finite float32.
  }
}

const Target network_target(
    "network", 4096,
    []() -> Seeds {
      const testing::NpzArrays network = testing::network_files();
      std::string arrays;
      for (const auto& [name, data] : network)
        arrays += (arrays.empty() ? "" : std::string(1, separator)) + data;
      return {testing::zip(network), arrays};
    },
    [](std::string_view bytes) {
      const bool is_archive = is_valid([&] { read_network(std::string(bytes)); });
      testing::NpzArrays network = testing::network_files();
      const auto arrays = split<7>(bytes);
      for (std::size_t i = 0; i < arrays.size(); ++i)
        if (!arrays[i].empty()) network[i].second = arrays[i];
      return is_valid([&] { read_network(testing::zip(network)); }) || is_archive;
    });

}  // namespace
}  // namespace slalom::fuzz
