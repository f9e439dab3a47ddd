#pragma once

#include <cstdint>
#include <utility>

#include "slalom/core/problem_parts.hpp"
#include "slalom/core/sequence_batch.hpp"

/// The rollout loop: one sample a lane, the state in registers, several packs interleaved so that their
/// latencies hide behind each other.
namespace slalom::detail {

/// A state whose scalars are all given as float values, spread over the lanes of `T`.
template <class P, class T, std::size_t... I>
SLALOM_INLINE StateOf<P, T> broadcast_state(const float* x, std::index_sequence<I...>) {
  return StateOf<P, T>{T(x[I])...};
}

/// What a problem returns from a look-up.
template <class P, class F>
using SeenOf = decltype(look_up<P, F>(std::declval<const P&>(), std::declval<const StateOf<P, F>&>()));

/// Where no input has to be remembered.
struct NoInput {};
/// The inputs of the step before, of a problem that limits their rates.
template <class P, class F>
using HeldInput = std::conditional_t<limits_rates<P>, InputOf<P, F>, NoInput>;

template <class P, class F>
struct Rollout {
  StateOf<P, F> x;
  F total;
  mask_t<F> hit;
  [[no_unique_address]] HeldInput<P, F> previous;
};

/// How many values a rollout starts from: the state, then the inputs applied before where rates are limited.
template <class P>
inline constexpr int start_size = state_size<P> + (limits_rates<P> ? P::inputs : 0);

template <class P>
using RolloutFunction = void (*)(const P&, const float*, const SequenceBatch&, int, int, float*,
                                 std::uint8_t*);

#if defined(__clang__)
#define SLALOM_UNROLL _Pragma("clang loop unroll(full)")
#else
#define SLALOM_UNROLL _Pragma("GCC unroll 8")
#endif

/// The rollouts of `packs` packs of samples from `sample` on, all in flight at once: enough to hide
/// latencies, few enough for the registers. All samples start from one state, so what is seen there is looked
/// up once. With `ahead` 1 what a pack sees is looked up while the pack before it takes its step: a processor
/// does not see past one pack's step to the loads of the next. That costs registers, of which the narrow sets
/// have few.
#define SLALOM_ROLL_OUT(Target, packs, ahead)                                                                \
  Rollout<P, F> r[packs];                                                                                    \
  SLALOM_UNROLL for (int j = 0; j < packs; ++j) {                                                            \
    r[j].x = start;                                                                                          \
    r[j].total = F(0.0f);                                                                                    \
    r[j].hit = mask_t<F>(false);                                                                             \
    if constexpr (limits_rates<P>) r[j].previous = before;                                                   \
  }                                                                                                          \
  SeenOf<P, F> seen = seen_first;                                                                            \
  const float* row = batch.row(0, 0) + sample;                                                               \
  for (int k = 0; k < steps; ++k, row += P::inputs * stride) {                                               \
    SLALOM_UNROLL for (int j = 0; j < packs; ++j) {                                                          \
      SeenOf<P, F> looked =                                                                                  \
          k == 0 && j + ahead < packs ? seen_first : look_up<P, F>(problem, r[(j + ahead) % packs].x);       \
      const SeenOf<P, F>& now = ahead ? seen : looked;                                                       \
      InputOf<P, F> u;                                                                                       \
      SLALOM_UNROLL for (int i = 0; i < P::inputs; ++i) u[i] = F::load(row + i * stride + j * F::lanes);     \
      if constexpr (limits_rates<P>) hold_rate(u, r[j].previous, reach);                                     \
      accumulate<F>(stage_cost<P, F>(problem, r[j].x, now, u, k), r[j].total, r[j].hit);                     \
      r[j].x = step<P, F>(problem, r[j].x, now, u, k);                                                       \
      if constexpr (ahead != 0) seen = looked;                                                               \
    }                                                                                                        \
  }                                                                                                          \
  SLALOM_UNROLL for (int j = 0; j < packs; ++j) {                                                            \
    SeenOf<P, F> looked = j + ahead < packs ? look_up<P, F>(problem, r[(j + ahead) % packs].x) : seen_first; \
    const SeenOf<P, F>& now = ahead ? seen : looked;                                                         \
    accumulate<F>(terminal_cost<P, F>(problem, r[j].x, now), r[j].total, r[j].hit);                          \
    if constexpr (ahead != 0) seen = looked;                                                                 \
    r[j].total.store(costs + sample + j * F::lanes);                                                         \
    simd::Operations<simd::Target>::store_mask(r[j].hit.v, collided + sample + j * F::lanes);                \
  }

/// Defines the rollout loop `rollout_<name>` for one instruction set: `packs` packs at a time, and the rest
/// one by one. Macros because clang inlines only the calls that stand in the body of a `flatten` function
/// itself: so the problem's functions are called right here.
#define SLALOM_DEFINE_ROLLOUT(name, ATTRIBUTES, Target, packs, ahead)                                      \
  template <class P>                                                                                       \
  ATTRIBUTES void rollout_##name(const P& problem, const float* initial_state, const SequenceBatch& batch, \
                                 int first, int count, float* costs, std::uint8_t* collided) {             \
    using F = Pack<simd::Target>;                                                                          \
    static_assert(simd::padding % F::lanes == 0);                                                          \
    const int steps = batch.steps();                                                                       \
    const std::ptrdiff_t stride = batch.stride();                                                          \
    const StateOf<P, F> start =                                                                            \
        broadcast_state<P, F>(initial_state, std::make_index_sequence<state_size<P>>{});                   \
    const SeenOf<P, F> seen_first = look_up<P, F>(problem, start);                                         \
    HeldInput<P, F> reach, before;                                                                         \
    if constexpr (limits_rates<P>) {                                                                       \
      for (int i = 0; i < P::inputs; ++i) {                                                                \
        reach[i] = F(static_cast<float>(input_step(problem, i)));                                          \
        before[i] = F(initial_state[state_size<P> + i]);                                                   \
      }                                                                                                    \
    }                                                                                                      \
    const int end = first + count;                                                                         \
    int sample = first;                                                                                    \
    for (; sample + (packs - 1) * F::lanes < end; sample += packs * F::lanes) {                            \
      SLALOM_ROLL_OUT(Target, packs, ahead)                                                                \
    }                                                                                                      \
    for (; sample < end; sample += F::lanes) {                                                             \
      SLALOM_ROLL_OUT(Target, 1, 0)                                                                        \
    }                                                                                                      \
  }

SLALOM_DEFINE_ROLLOUT(generic, SLALOM_TARGET_GENERIC, Generic, 2, 0)
#if SLALOM_X86
SLALOM_DEFINE_ROLLOUT(sse4, SLALOM_TARGET_SSE4, Sse4, 2, 0)
SLALOM_DEFINE_ROLLOUT(avx2, SLALOM_TARGET_AVX2, Avx2, 4, 1)
SLALOM_DEFINE_ROLLOUT(avx512, SLALOM_TARGET_AVX512, Avx512, 4, 1)
#endif

#undef SLALOM_DEFINE_ROLLOUT
#undef SLALOM_ROLL_OUT

/// The rollout loop of a problem for an instruction set.
template <class P>
RolloutFunction<P> rollout_function(simd::Target target) {
#if SLALOM_X86
  switch (target) {
    case simd::Target::avx512:
      return rollout_avx512<P>;
    case simd::Target::avx2:
      return rollout_avx2<P>;
    case simd::Target::sse4:
      return rollout_sse4<P>;
    case simd::Target::generic:
      break;
  }
#else
  static_cast<void>(target);
#endif
  return rollout_generic<P>;
}

}  // namespace slalom::detail
