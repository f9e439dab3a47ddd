#pragma once

#include "slalom/core/dispatch.hpp"
#include "slalom/core/problem_parts.hpp"
#include "slalom/core/sequence_batch.hpp"

/// The rollout loop: one sample per lane, and the state in registers. Several packs are interleaved, so that
/// each computes while others wait.
namespace slalom::detail {

// Clang warns where the list of scalars below fills the arrays of a state without inner braces.
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wmissing-braces"
#endif
/// Returns a state whose scalars are the values `x`, each in all lanes of `T`.
template <class P, class T, std::size_t... I>
SLALOM_INLINE StateOf<P, T> broadcast_state(const float* x, std::index_sequence<I...>) {
  return StateOf<P, T>{T(x[I])...};
}
#if defined(__clang__)
#pragma clang diagnostic pop
#endif

/// The type that a problem returns from a look-up.
template <class P, class F>
using SeenOf = decltype(look_up<P, F>(std::declval<const P&>(), std::declval<const StateOf<P, F>&>()));

/// Takes the place of what a problem does not need.
struct NoInput {};
/// The inputs of the previous step if the problem limits their rates, or the remainder of its levels.
template <class P, class F>
using HeldInput = std::conditional_t<carries_inputs<P>, InputOf<P, F>, NoInput>;

/// The rollouts of one pack while they run.
template <class P, class F>
struct Rollout {
  StateOf<P, F> x;
  F total;        ///< cost so far
  mask_t<F> hit;  ///< whether a state collided so far
  [[no_unique_address]] HeldInput<P, F> previous;
};

/// Data that all rollouts of a batch have in common.
template <class P, class F>
struct RolloutStart {
  StateOf<P, F> x;
  SeenOf<P, F> seen;                               ///< looked up once, since all start from one state
  [[no_unique_address]] HeldInput<P, F> previous;  ///< the inputs applied before, or the remainder
  /// How far an input may move in a step, or its levels.
  [[no_unique_address]] std::conditional_t<has_levels<P>, Levels<F, P::inputs>, HeldInput<P, F>> reach;
};

/// Size of the start of a rollout: the state, then the previous inputs or remainders that it carries.
template <class P>
inline constexpr int start_size = state_size<P> + (carries_inputs<P> ? P::inputs : 0);

/// The inputs of a batch: for each step and input a row with a value for each sample.
struct InputRows {
  const float* values;
  std::ptrdiff_t stride;  ///< from a row to the next
  int steps;
};

#if defined(__clang__)
/// Unrolls the next loop.
#define SLALOM_UNROLL _Pragma("clang loop unroll(full)")
#else
/// Unrolls the next loop.
#define SLALOM_UNROLL _Pragma("GCC unroll 8")
#endif

/// Makes the start of the rollouts of a batch from the `start_size` values `initial`.
template <class P, class F>
SLALOM_INLINE_CALLS RolloutStart<P, F> rollout_start(const P& problem, const float* initial) {
  RolloutStart<P, F> start;
  start.x = broadcast_state<P, F>(initial, std::make_index_sequence<state_size<P>>{});
  start.seen = look_up<P, F>(problem, start.x);
  if constexpr (carries_inputs<P>)
    for (int i = 0; i < P::inputs; ++i) start.previous[i] = F(initial[state_size<P> + i]);
  if constexpr (limits_rates<P>)
    for (int i = 0; i < P::inputs; ++i) start.reach[i] = F(static_cast<float>(input_step(problem, i)));
  if constexpr (has_levels<P>) start.reach = levels_of<F>(problem);
  return start;
}

/// Computes the rollouts of `packs` packs of samples, beginning at `sample`. The packs advance together, so
/// that each computes while others wait. With `ahead` 1, each pack does its look-up before the previous pack
/// takes its step, since a processor does not look that far ahead by itself.
template <int packs, int ahead, class P, class F>
SLALOM_INLINE_CALLS void roll_out(const P& problem, const RolloutStart<P, F>& start, const InputRows& rows,
                                  int sample, float* costs, std::uint8_t* collided) {
  Rollout<P, F> r[packs];
  SeenOf<P, F> seen[packs];  // look-ups of the packs that take their step next
  SLALOM_UNROLL for (int j = 0; j < packs; ++j) {
    r[j].x = start.x;
    r[j].total = F(0.0f);
    r[j].hit = mask_t<F>(false);
    if constexpr (carries_inputs<P>) r[j].previous = start.previous;
  }
  seen[0] = start.seen;
  const float* row = rows.values + sample;
  for (int k = 0; k < rows.steps; ++k, row += P::inputs * rows.stride) {
    SLALOM_UNROLL for (int j = 0; j < packs; ++j) {
      const int next = (j + ahead) % packs;
      seen[next] = k == 0 && j + ahead < packs ? start.seen : look_up<P, F>(problem, r[next].x);
      InputOf<P, F> u;
      SLALOM_UNROLL for (int i = 0; i < P::inputs; ++i) u[i] = F::load(row + i * rows.stride + j * F::lanes);
      if constexpr (limits_rates<P>) hold_rate(u, r[j].previous, start.reach);
      if constexpr (has_levels<P>) hold_levels(u, r[j].previous, start.reach);
      accumulate<F>(stage_cost<P, F>(problem, r[j].x, seen[j], u, k), r[j].total, r[j].hit);
      r[j].x = step<P, F>(problem, r[j].x, seen[j], u, k);
    }
  }
  SLALOM_UNROLL for (int j = 0; j < packs; ++j) {
    if (j + ahead < packs) seen[j + ahead] = look_up<P, F>(problem, r[j + ahead].x);
    accumulate<F>(terminal_cost<P, F>(problem, r[j].x, seen[j]), r[j].total, r[j].hit);
    r[j].total.store(costs + sample + j * F::lanes);
    r[j].hit.store(collided + sample + j * F::lanes);
  }
}

#undef SLALOM_UNROLL

/// Computes the rollouts of samples from `sample` to `end`, `packs` packs at a time and the rest one by one.
template <int packs, int ahead, class P, class F>
SLALOM_INLINE_CALLS void roll_out_all(const P& problem, const RolloutStart<P, F>& start,
                                      const InputRows& rows, int sample, int end, float* costs,
                                      std::uint8_t* collided) {
  for (; sample + (packs - 1) * F::lanes < end; sample += packs * F::lanes)
    roll_out<packs, ahead>(problem, start, rows, sample, costs, collided);
  for (; sample < end; sample += F::lanes) roll_out<1, 0>(problem, start, rows, sample, costs, collided);
}

/// Computes the rollouts of the samples `first` ... `first + count - 1`, as many packs at a time as suit the
/// instruction set (docs/performance.md); if steps are long, a pair of packs. `initial` holds `start_size`
/// values.
template <class Target, class P>
SLALOM_INLINE_CALLS void roll_out_range(const P& problem, const float* initial, const InputRows& rows,
                                        int first, int count, float* costs, std::uint8_t* collided) {
  using F = Pack<Target>;
  static_assert(simd::padding % F::lanes == 0);
  const RolloutStart<P, F> start = rollout_start<P, F>(problem, initial);
  const int end = first + count;
  if constexpr (has_long_steps<P>) {
    const RolloutStart<P, PackPair<Target>> both = rollout_start<P, PackPair<Target>>(problem, initial);
    int sample = first;
    for (; sample + F::lanes < end; sample += 2 * F::lanes)
      roll_out<1, 0>(problem, both, rows, sample, costs, collided);
    roll_out_all<1, 0>(problem, start, rows, sample, end, costs, collided);
  } else if constexpr (Target::lanes == 4) {
    roll_out_all<2, 0>(problem, start, rows, first, end, costs, collided);
  } else {
    roll_out_all<4, 1>(problem, start, rows, first, end, costs, collided);
  }
}

/// The kernel of a problem's rollouts: costs and collisions of samples of a batch.
template <class P>
struct RolloutKernel {
  template <class Target>
  SLALOM_KERNEL static void run(const P& problem, const float* initial, const SequenceBatch& batch, int first,
                                int count, float* costs, std::uint8_t* collided) {
    const InputRows rows{batch.data(), batch.stride(), batch.steps()};
    roll_out_range<Target>(problem, initial, rows, first, count, costs, collided);
  }
};

}  // namespace slalom::detail
