#pragma once

#include "slalom/gpu/kernels/arguments.hpp"

namespace slalom::gpu {

/// Steps that are unrolled, of a guide twice as many: they hide latency. A problem with long steps has
/// `unrolled_steps` 1.
template <class P>
constexpr int unrolled_steps() {
  if constexpr (requires { P::unrolled_steps; }) return P::unrolled_steps;
  return 4;
}

/// One sample on its way through the horizon, as core/rollout.hpp has it for packs.
template <class P>
class Rollout {
 public:
  using Inputs = detail::InputOf<P, float>;

  explicit Rollout(const Arguments<P>& a) : problem_(*reinterpret_cast<const P*>(a.problem)) {
    static_assert(sizeof x_ == sizeof(float) * detail::state_size<P>);
    static_assert(!detail::has_levels<P>, "slalom: problems with input_levels are not solved on a GPU");
    memcpy(&x_, a.start, sizeof x_);
    if constexpr (detail::limits_rates<P>) {
      for (int i = 0; i < P::inputs; ++i) {
        reach_[i] = static_cast<float>(detail::input_step(problem_, i));
        previous_[i] = a.start[detail::state_size<P> + i];
      }
    }
  }

  void step(Inputs u, int k) {
    if constexpr (detail::limits_rates<P>) detail::hold_rate(u, previous_, reach_);
    const auto seen = detail::look_up<P, float>(problem_, x_);
    detail::accumulate<float>(detail::stage_cost<P, float>(problem_, x_, seen, u, k), sum_, hit_);
    x_ = detail::step<P, float>(problem_, x_, seen, u, k);
  }

  /// The cost, infinite where it is not finite.
  float finish() {
    const auto seen = detail::look_up<P, float>(problem_, x_);
    detail::accumulate<float>(detail::terminal_cost<P, float>(problem_, x_, seen), sum_, hit_);
    return is_finite(sum_) ? sum_ : infinite;
  }
  /// Whether a state collided.
  bool collided() const { return hit_; }

 private:
  const P& problem_;
  detail::StateOf<P, float> x_;
  Inputs previous_, reach_;
  float sum_ = 0;
  bool hit_ = false;
};

/// Rolls out the sequence value(row).
template <int unrolled, class P, class Value>
void roll_out(const Arguments<P>& a, Rollout<P>& rollout, Value&& value) {
  SLALOM_UNROLLED(unrolled)
  for (int k = 0; k < a.settings.horizon; ++k) {
    typename Rollout<P>::Inputs u;
    SLALOM_UNROLLED()
    for (int i = 0; i < P::inputs; ++i) u[i] = value(k * P::inputs + i);
    rollout.step(u, k);
  }
}

}  // namespace slalom::gpu
