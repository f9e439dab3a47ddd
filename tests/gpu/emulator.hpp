#pragma once

#include <vector>

#include "slalom/gpu/settings.hpp"

namespace slalom::gpu {

/// Solves with the kernels' source, whose blocks run as loops on the host.
template <class P, class Options>
class Emulator {
  static constexpr bool guided = std::is_same_v<Options, SvgMppiOptions>;

 public:
  Emulator(const P& problem, const Options& options, const Shape& shape)
      : settings_(settings_of(options, P::inputs, shape)), time_step_(slalom::detail::time_step_of(problem)) {
    const Settings& s = settings_;
    const auto rows = static_cast<std::size_t>(s.horizon * P::inputs);
    mean_.resize(rows), nominal_.resize(rows), variance_.resize(rows), plan_.resize(rows);
    partial_.resize(static_cast<std::size_t>(s.groups * padded_rows(s.horizon * P::inputs)));
    sums_.resize(static_cast<std::size_t>(s.groups));
    if (guided) theta_.resize(static_cast<std::size_t>(guide_doubles(s, s.horizon * P::inputs)));
    memory_.resize(static_cast<std::size_t>(
        std::max(sample_floats(s, s.horizon * P::inputs), guide_floats_of(s, s.horizon * P::inputs)) / 2 +
        1));
    std::memset(static_cast<void*>(&a_), 0, sizeof a_);
    std::memcpy(a_.problem, static_cast<const void*>(&problem), sizeof problem);
    a_.settings = s;
    a_.buffers = {mean_.data(), nominal_.data(), variance_.data(), theta_.data(), partial_.data(),
                  sums_.data(), nullptr,         nullptr,          plan_.data(),  &report_};
    a_.seed = options.seed;
    reset(a_, memory());
  }

  void solve(const slalom::detail::StateOf<P, double>& x, double elapsed) {
    double values[slalom::detail::state_size<P>];
    std::memcpy(values, &x, sizeof values);
    std::copy_n(values, slalom::detail::state_size<P>, a_.start);
    a_.stream = (solves_ << 16) | (guided ? 1u : 0u);
    a_.shift = Shift::of(time_step_ > 0 ? elapsed / time_step_ : 0, settings_.horizon);
    a_.solve = static_cast<unsigned>(++solves_);
    if constexpr (guided) {
      for (int g = 0; g < settings_.guides; ++g) MovingGuide<P>(a_, g, memory()).run();
      finish_guides(a_, memory());
    }
    for (int group = 0; group < settings_.groups; ++group) solve_group<P, guided>(a_, group, memory());
    combine<P, guided>(a_, memory());
  }

  const std::vector<float>& plan() const { return plan_; }        ///< [step][input]
  const std::vector<float>& nominal() const { return nominal_; }  ///< [step][input]
  const Report& report() const { return report_; }                ///< of the last solve

 private:
  float* memory() { return reinterpret_cast<float*>(memory_.data()); }

  Settings settings_;
  double time_step_;
  unsigned long long solves_ = 0;
  std::vector<float> mean_, nominal_, variance_, plan_, partial_;
  std::vector<double> theta_, memory_;
  std::vector<GroupSums> sums_;
  Report report_{};
  Arguments<P> a_;
};

}  // namespace slalom::gpu
