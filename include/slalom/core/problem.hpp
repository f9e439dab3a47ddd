#pragma once

#include <array>

#include "slalom/core/math.hpp"

/// A problem: dynamics and cost written once, as templates over the scalar type `T`, which is `double`,
/// `float` or a pack of SIMD lanes.
///
///     struct Pendulum {                                        // angle measured from upright
///       template <class T> struct State { T angle, rate; };    // rad, rad/s
///       static constexpr int inputs = 1;                       // torque, N m
///       template <class T> State<T> step(const State<T>& x, const Input<T, 1>& u) const;
///       template <class T> T stage_cost(const State<T>& x, const Input<T, 1>& u) const;
///       template <class T> T terminal_cost(const State<T>& x) const;    // optional
///     };
///
/// `State<T>` is an aggregate of `T` (nested arrays are fine). Optional:
///  - `step` and `stage_cost` may take the step index `int k` (0 ... horizon - 1) as their last argument;
///  - `template <class T> auto look_up(const State<T>& x) const`: the values of maps at a state. It is called
///    once per state; `step`, `stage_cost` and `terminal_cost` then take its result after the state;
///  - a cost may be returned as `Cost<T>`, which also says whether the state collides, or as
///    `CostTerms<T, N>`, whose terms have names:
///    `static constexpr std::array cost_names{"distance", "effort"}`. Plans report each term;
///  - a member `dt` or a function `time_step()`: the duration of a step, s. With it solvers shift their last
///    solution by the time that has passed;
///  - members `input_min` and `input_max`, a `double` or a `std::array<double, inputs>`: bounds in
///    addition to those of a method's options, read when a controller is made;
///  - a member `input_rate_max`, of the same type: the largest rate of each input in rollouts and plans, 1/s;
///  - a member `input_levels`, of the same type: the number of evenly spaced values from `input_min` to
///    `input_max` that an input takes, for instance 3 for a thruster that pushes, pulls or is off; 0: all
///    values;
///  - `void sample(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept`: its own
///    noise instead of independent standard normal values (see `Sampler`);
///  - `static constexpr bool long_steps = true`: a step has several hundred instructions, so
///    rollouts of two packs at a time are faster. Results do not change (see pack/pair.hpp).
namespace slalom {

/// The `M` inputs of one step.
template <class T, int M>
struct Input {
  /// One value for each input.
  T value[M];

  T& operator[](int i) { return value[i]; }
  const T& operator[](int i) const { return value[i]; }
  /// Number of inputs.
  static constexpr int size() { return M; }
};

/// A cost that also says whether its state collides.
template <class T>
struct Cost {
  T value;             ///< the cost
  mask_t<T> collided;  ///< whether the state collides
};

/// A cost as a sum of terms, which the problem names in `cost_names`: `{{a, b}}` or `{{a, b}, hit}`.
template <class T, int N>
struct CostTerms {
  /// The cost terms, in the order of their names.
  T value[N];
  /// Whether the state collides.
  mask_t<T> collided = mask_t<T>(false);
};

/// Replaces the look-up of a problem that has none.
struct NoLookUp {};

namespace detail {

template <class P, class T>
using StateOf = typename P::template State<T>;
template <class P, class T>
using InputOf = Input<T, P::inputs>;

template <class P, class T>
inline constexpr bool looks_up = requires(const P& p, const StateOf<P, T>& x) {
  p.look_up(x);
};

template <class P, class T>
SLALOM_INLINE_CALLS auto look_up(const P& problem, const StateOf<P, T>& x) {
  if constexpr (looks_up<P, T>) {
    return problem.look_up(x);
  } else {
    return NoLookUp{};
  }
}

template <class P, class T, class L>
SLALOM_INLINE_CALLS StateOf<P, T> step(const P& p, const StateOf<P, T>& x, const L& seen,
                                       const InputOf<P, T>& u, int k) {
  if constexpr (looks_up<P, T>) {
    if constexpr (requires { p.step(x, seen, u, k); }) {
      return p.step(x, seen, u, k);
    } else {
      return p.step(x, seen, u);
    }
  } else if constexpr (requires { p.step(x, u, k); }) {
    return p.step(x, u, k);
  } else {
    return p.step(x, u);
  }
}

template <class P, class T, class L>
SLALOM_INLINE_CALLS auto stage_cost(const P& p, const StateOf<P, T>& x, const L& seen, const InputOf<P, T>& u,
                                    int k) {
  if constexpr (looks_up<P, T>) {
    if constexpr (requires { p.stage_cost(x, seen, u, k); }) {
      return p.stage_cost(x, seen, u, k);
    } else {
      return p.stage_cost(x, seen, u);
    }
  } else if constexpr (requires { p.stage_cost(x, u, k); }) {
    return p.stage_cost(x, u, k);
  } else {
    return p.stage_cost(x, u);
  }
}

/// Has the name `terminal_cost` twice if a problem has it, too, and then naming it is ambiguous.
struct TerminalCostName {
  int terminal_cost;
};
template <class P>
struct TerminalCostProbe : P, TerminalCostName {};
/// Whether a problem has no member `terminal_cost` at all, neither a right nor a wrong one.
template <class P>
concept LacksTerminalCost = !std::is_final_v<P> && requires {
  &TerminalCostProbe<P>::terminal_cost;
};

template <class P, class T, class L>
SLALOM_INLINE_CALLS auto terminal_cost(const P& p, const StateOf<P, T>& x, const L& seen) {
  if constexpr (LacksTerminalCost<P>) {
    return T(0);
  } else if constexpr (looks_up<P, T>) {
    return p.terminal_cost(x, seen);
  } else {
    return p.terminal_cost(x);
  }
}

/// Adds a cost, plain or with collision, to the running sums of a rollout.
template <class T>
SLALOM_INLINE void accumulate(const T& cost, T& total, mask_t<T>&) {
  total = total + cost;
}
template <class T>
SLALOM_INLINE void accumulate(const Cost<T>& cost, T& total, mask_t<T>& collided) {
  total = total + cost.value;
  collided = collided | cost.collided;
}
template <class T, int N, int I = 0>
SLALOM_INLINE T sum_of(const CostTerms<T, N>& cost) {
  if constexpr (I + 1 < N) {
    return cost.value[I] + sum_of<T, N, I + 1>(cost);
  } else {
    return cost.value[I];
  }
}
template <class T, int N>
SLALOM_INLINE void accumulate(const CostTerms<T, N>& cost, T& total, mask_t<T>& collided) {
  total = total + sum_of(cost);
  collided = collided | cost.collided;
}

/// Number of scalars of a state.
template <class P>
inline constexpr int state_size = static_cast<int>(sizeof(StateOf<P, double>) / sizeof(double));

}  // namespace detail

/// Problems as described above.
template <class P>
concept Problem = requires(const P& p, const detail::StateOf<P, double>& x,
                           const Input<double, P::inputs>& u) {
  requires P::inputs >
  0;
  requires std::is_trivially_copyable_v<detail::StateOf<P, double>>;
  requires sizeof(detail::StateOf<P, double>) % sizeof(double) == 0;
  {
    detail::step<P, double>(p, x, detail::look_up<P, double>(p, x), u, 0)
    } -> std::same_as<detail::StateOf<P, double>>;
  detail::stage_cost<P, double>(p, x, detail::look_up<P, double>(p, x), u, 0);
  detail::terminal_cost<P, double>(p, x, detail::look_up<P, double>(p, x));
};

}  // namespace slalom
