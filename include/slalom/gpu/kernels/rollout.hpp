#pragma once

#include "slalom/gpu/kernels/arguments.hpp"
#include "slalom/gpu/kernels/block.hpp"

namespace slalom::gpu {

/// Steps that are unrolled, of a guide twice as many: they hide latency; 1 where a step is long.
#if !defined(SLALOM_UNROLL_STEPS)
#define SLALOM_UNROLL_STEPS 4
#endif
#if SLALOM_ON_GPU && SLALOM_UNROLL_STEPS == 1
#define SLALOM_UNROLL_OCTET _Pragma("unroll 1")
#else
#define SLALOM_UNROLL_OCTET SLALOM_UNROLL_ALL
#endif

/// One sample on its way through the horizon, as core/rollout.hpp has it for packs.
template <class P>
class Rollout {
 public:
  using Inputs = detail::InputOf<P, float>;

  explicit Rollout(const Arguments<P>& a) : problem_(problem_of(a)) {
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

/// Rolls out the sequence v[row * stride]. `use(row, value)` sees every value on its way.
template <class P, int unroll, class Use>
void roll_out(const Arguments<P>& a, const float* v, int stride, Rollout<P>& rollout, Use&& use) {
#if SLALOM_ON_GPU
#pragma unroll unroll
#endif
  for (int k = 0; k < a.settings.horizon; ++k) {
    typename Rollout<P>::Inputs u;
    SLALOM_UNROLL_ALL
    for (int i = 0; i < P::inputs; ++i) {
      const int r = k * P::inputs + i;
      u[i] = v[r * stride];
      use(r, u[i]);
    }
    rollout.step(u, k);
  }
}

/// The cost alone.
template <class P>
float cost_of(const Arguments<P>& a, const float* v, int stride) {
  Rollout<P> rollout(a);
  roll_out<P, SLALOM_UNROLL_STEPS == 1 ? 1 : 2 * SLALOM_UNROLL_STEPS>(a, v, stride, rollout,
                                                                      [](int, float) {});
  return rollout.finish();
}

/// Entry `r` of a sequence [step][input] moved forward, as by `shift_sequence`.
template <class Real>
Real shifted(const Real* sequence, int r, int steps, int inputs, const Shift& shift) {
  const int k = r / inputs, i = r - k * inputs, before = k + shift.whole;
  if (before >= steps - 1) return sequence[(steps - 1) * inputs + i];
  const Real x = sequence[before * inputs + i], y = sequence[(before + 1) * inputs + i];
  return x + Real(shift.part) * (y - x);
}

}  // namespace slalom::gpu
