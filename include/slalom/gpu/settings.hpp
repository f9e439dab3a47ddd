#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "slalom/core/option_access.hpp"
#include "slalom/gpu/kernels/guides.hpp"
#include "slalom/gpu/kernels/samples.hpp"
#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom::gpu {

/// Floats of shared memory that a block may take: 64 KiB, which every GPU from architecture 75 on has.
constexpr int most_shared_floats = 16384;
/// The most groups of tiles, each for a block.
constexpr int most_groups = 256;
/// Groups that keep a large GPU busy.
constexpr int enough_groups = 128;
/// Samples from which a thread draws its own sample.
constexpr int fused_samples = 32768;

/// The distribution of the samples over blocks. It is a function of the problem's size alone, so that the
/// results do not depend on the device.
struct Shape {
  bool fused = false;  ///< each thread draws and rolls out its own sample
  int tile = 32;       ///< samples of a tile

  /// Returns the shape for a problem with so many inputs and steps.
  static Shape of(int inputs, int horizon, int samples) {
    if (8 % inputs == 0 && samples >= fused_samples) return {true, block_threads};
    Shape shape;
    while (shape.tile < block_threads && samples / shape.tile > enough_groups &&
           tile_floats(horizon * inputs, 2 * shape.tile, false) <= most_shared_floats)
      shape.tile *= 2;
    return shape;
  }
};

/// The values that a GPU needs of options that it does not have: one batch of white noise.
template <class Options>
Options gpu_defaults() {
  Options o;
  o.noise = {};
  if constexpr (requires { o.batches; }) o.batches = 1;
  return o;
}

/// Refuses options that a GPU does not have, and temperatures that would follow from the costs.
template <class Options>
void require_supported(const Options& options) {
  constexpr std::string_view supported =
      " horizon samples temperature variance input_min input_max shift_warm_start control_cost_discount seed "
      "threads guides guide_iterations guide_step guide_variance gradient_samples gradient_variance "
      "gradient_temperature restart_guides restart_variance variance_min variance_max ";
  const auto defaults = list_options(gpu_defaults<Options>());
  const auto entries = list_options(options);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string name = entries[i].declaration.name;
    const bool known = supported.find(" " + name + " ") != std::string_view::npos;
    if (!known && !(entries[i] == defaults[i])) {
      throw std::invalid_argument(std::string(Options::method) + "." + name + ": " +
                                  to_text(entries[i].value) + " must be " + to_text(defaults[i].value) +
                                  " on a GPU");
    }
    if (name.ends_with("temperature") && known && to_text(entries[i].value) == "0")
      throw std::invalid_argument(std::string(Options::method) + "." + name + ": 0 must be above 0 on a GPU");
  }
}

/// Floats of shared memory of a block of samples.
inline int sample_floats(const Settings& s, int rows) {
  return std::max(tile_floats(rows, s.tile, s.fused), combine_floats(rows, s.groups));
}
/// The same of a block of a guide, and of `reset`.
inline int guide_floats_of(const Settings& s, int rows) {
  return s.guides > 0 ? std::max(guide_floats(s, rows), rows << log2_of(s.guides)) : 4;
}

/// The settings of a solve. Throws std::invalid_argument on options out of range, on options that a GPU does
/// not have, and where a tile or a guide does not fit into the shared memory. Tests give a shape.
template <class Options>
Settings settings_of(const Options& given_options, int inputs, std::optional<Shape> given = {}) {
  constexpr bool guided = std::is_same_v<Options, SvgMppiOptions>;
  validate_options(given_options, Options::method, inputs);
  require_supported(given_options);
  Options o = given_options;
  if constexpr (guided) {
    o = slalom::detail::with_guide_variances(o, inputs);
  } else {
    o = slalom::detail::with_variances(o, inputs);
  }
  if (inputs > most_inputs)
    throw std::invalid_argument("problem: has " + std::to_string(inputs) + " inputs, a GPU takes at most " +
                                std::to_string(most_inputs));
  const int rows = o.horizon * inputs;
  Settings s{};
  s.horizon = o.horizon, s.samples = o.samples;
  const Shape shape = given ? *given : Shape::of(inputs, o.horizon, o.samples);
  s.fused = shape.fused, s.tile = shape.tile;
  s.tiles = (o.samples + s.tile - 1) / s.tile;
  s.groups = std::min(s.tiles, most_groups);
  s.temperature = float(o.temperature);
  s.control_factor = float(o.temperature * (1 - o.control_cost_discount));
  for (int i = 0; i < inputs; ++i)
    s.low[i] = float(o.input_min[i]), s.high[i] = float(o.input_max[i]), s.variance[i] = float(o.variance[i]);
  int floats = sample_floats(s, rows);
  if constexpr (guided) {
    s.guides = o.guides.count, s.iterations = o.guides.iterations,
    s.gradient_samples = o.guides.gradient_samples;
    s.gradient_temperature = float(o.guides.gradient_temperature);
    s.restart = o.guides.restart;
    for (int i = 0; i < inputs; ++i) {
      s.guide_step[i] = float(o.guides.step[i]);
      s.restart_variance[i] = o.guides.restart_variance[i];
      s.variance_min[i] = o.variance_min[i], s.variance_max[i] = o.variance_max[i];
      s.guide_variance[i] = float(o.guides.variance[i]);
      s.gradient_variance[i] = float(o.guides.gradient_variance[i]);
    }
    floats = std::max(floats, guide_floats_of(s, rows));
  }
  if (floats > most_shared_floats) {
    throw std::invalid_argument(std::string(Options::method) + ".horizon: " + std::to_string(o.horizon) +
                                " steps of " + std::to_string(inputs) + " inputs" +
                                (guided ? ", or the samples of a guide," : "") +
                                " do not fit into 64 KiB of a GPU's shared memory");
  }
  return s;
}

}  // namespace slalom::gpu
