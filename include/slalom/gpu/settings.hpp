#pragma once

#include "slalom/core/option_access.hpp"
#include "slalom/gpu/kernels/guides.hpp"
#include "slalom/gpu/kernels/samples.hpp"
#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom::gpu {

/// Refuses options that a GPU does not have, and temperatures that would follow from the costs.
template <class Options>
void require_supported(const Options& options) {
  constexpr std::string_view supported =
      " horizon samples temperature variance input_min input_max shift_warm_start seed "
      "threads guides guide_iterations guide_step guide_variance gradient_samples gradient_variance "
      "gradient_temperature restart_guides restart_variance variance_min variance_max ";
  Options plain;  // one batch of white noise
  plain.noise = {};
  if constexpr (requires { plain.batches; }) plain.batches = 1;
  const auto defaults = list_options(plain), entries = list_options(options);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string name = entries[i].declaration.name, value = to_text(entries[i].value);
    const bool known = supported.find(" " + name + " ") != std::string_view::npos;
    const auto refuse = [&](const std::string& rule) {
      throw std::invalid_argument(std::string(Options::method) + "." + name + ": " + value + " must be " +
                                  rule + " on a GPU");
    };
    if (!known && !(entries[i] == defaults[i])) refuse(to_text(defaults[i].value));
    if (name.ends_with("temperature") && known && value == "0") refuse("above 0");
  }
}

/// Bytes of shared memory of a block of samples.
inline int sample_bytes(const Settings& s, int rows) {
  return 4 * std::max(sample_floats(rows, s.tile, s.fused), combine_floats(rows, s.groups));
}
/// Bytes of shared memory of the block of a guide.
inline int guide_bytes(const Settings& s, int rows) {
  return 4 * guide_floats(s, rows, draws_ahead(s, rows) ? 2 : 1);
}

/// Spreads the samples over blocks. The result is a function of the problem's size alone, so that plans do
/// not depend on the device: threads draw the samples that they roll out where there are many, else a block
/// draws small tiles together, so that 128 groups keep a large GPU busy.
template <class P>
void spread_samples(Settings& s) {
  constexpr int fused_samples = 32768, enough_groups = 128, most_groups = 256;
  const int rows = s.horizon * P::inputs;
  s.fused = can_fuse<P> && s.samples >= fused_samples;
  s.tile = s.fused ? block_threads : 32;
  while (s.tile < block_threads && s.samples / s.tile > enough_groups &&
         4 * sample_floats(rows, 2 * s.tile, false) <= most_shared_bytes)
    s.tile *= 2;
  s.tiles = (s.samples + s.tile - 1) / s.tile;
  s.groups = std::min(s.tiles, most_groups);
}

/// The settings of a solve. The bounds of the problem narrow those of the options. Throws
/// std::invalid_argument on options out of range, on options that a GPU does not have, and where a tile or a
/// guide does not fit into the shared memory.
template <class P, class Options>
Settings settings_of(const P& problem, Options o) {
  constexpr bool guided = std::is_same_v<Options, SvgMppiOptions>;
  static_assert(P::inputs <= most_inputs, "slalom: on a GPU a problem has at most 16 inputs");
  validate_options(o, Options::method, P::inputs);
  require_supported(o);
  InputBounds bounds = slalom::detail::stated_bounds(problem);
  for (std::size_t i = 0; i < P::inputs; ++i) {
    bounds.low[i] = std::max(bounds.low[i], o.input_min[static_cast<int>(i)]);
    bounds.high[i] = std::min(bounds.high[i], o.input_max[static_cast<int>(i)]);
  }
  o.input_min = bounds.low, o.input_max = bounds.high;
  Settings s{};
  const auto set = [](auto& values, const PerInput& from) {
    for (int i = 0; i < P::inputs; ++i)
      values[i] = static_cast<std::remove_cvref_t<decltype(*values)>>(from[i]);
  };
  s.horizon = o.horizon, s.samples = o.samples;
  s.temperature = float(o.temperature);
  if constexpr (guided) {
    o = slalom::detail::with_guide_variances(o, P::inputs);
    s.guides = o.guides.count, s.iterations = o.guides.iterations, s.restart = o.guides.restart;
    s.gradient_samples = o.guides.gradient_samples;
    s.gradient_temperature = float(o.guides.gradient_temperature);
    set(s.guide_step, o.guides.step), set(s.guide_variance, o.guides.variance);
    set(s.gradient_variance, o.guides.gradient_variance), set(s.restart_variance, o.guides.restart_variance);
    set(s.variance_min, o.variance_min), set(s.variance_max, o.variance_max);
  } else {
    o = slalom::detail::with_variances(o, P::inputs);
  }
  set(s.low, o.input_min), set(s.high, o.input_max), set(s.variance, o.variance);
  spread_samples<P>(s);
  const int rows = s.horizon * P::inputs;
  if (std::max(sample_bytes(s, rows), guided ? guide_bytes(s, rows) : 0) > most_shared_bytes) {
    throw std::invalid_argument(std::string(Options::method) + ".horizon: " + std::to_string(o.horizon) +
                                " steps of " + std::to_string(P::inputs) + " inputs" +
                                (guided ? ", or the samples of a guide," : "") +
                                " do not fit into 64 KiB of a GPU's shared memory");
  }
  return s;
}

}  // namespace slalom::gpu
