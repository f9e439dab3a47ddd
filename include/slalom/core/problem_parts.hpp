#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "slalom/core/final_check.hpp"
#include "slalom/core/problem.hpp"

/// The optional members of a problem: names of its cost terms, bounds of its inputs and of their rates, noise
/// of its own. A member that a problem does not have costs nothing.
namespace slalom {

/// A part of the cost of a control sequence, summed over its states.
struct CostTerm {
  const char* name = "";  ///< name in the problem; "stage" and "terminal" where it names none
  double value = 0;       ///< value in the problem's unit of cost
};

namespace detail {

// --- cost terms
template <class P>
using StageCostOf = decltype(stage_cost<P, double>(
    std::declval<const P&>(), std::declval<const StateOf<P, double>&>(),
    look_up<P, double>(std::declval<const P&>(), std::declval<const StateOf<P, double>&>()),
    std::declval<const InputOf<P, double>&>(), 0));
template <class P>
using TerminalCostOf = decltype(terminal_cost<P, double>(
    std::declval<const P&>(), std::declval<const StateOf<P, double>&>(),
    look_up<P, double>(std::declval<const P&>(), std::declval<const StateOf<P, double>&>())));

/// Whether a stage cost says whether its state collides.
template <class P>
inline constexpr bool can_collide = requires(StageCostOf<P> cost) {
  cost.collided;
};

template <class C>
inline constexpr int terms_in = 0;  ///< 0: a cost in one piece
template <class T, int N>
inline constexpr int terms_in<CostTerms<T, N>> = N;

/// Number of named terms of a problem's costs.
template <class P>
inline constexpr int named_terms =
    terms_in<StageCostOf<P>> > terms_in<TerminalCostOf<P>> ? terms_in<StageCostOf<P>>
                                                           : terms_in<TerminalCostOf<P>>;

template <class P>
inline constexpr bool names_costs = requires {
  std::size(P::cost_names);
};

/// The terms of a problem's cost, all 0: the stage's in one piece, those it names, the terminal one.
template <class P>
constexpr auto cost_terms_of() {
  constexpr int before = terms_in<StageCostOf<P>> == 0, after = terms_in<TerminalCostOf<P>> == 0;
  std::array<CostTerm, before + named_terms<P> + after> terms{};
  if constexpr (before) terms.front().name = "stage";
  if constexpr (after) terms.back().name = "terminal";
  if constexpr (named_terms < P >> 0) {
    static_assert(names_costs<P>,
                  "slalom: a problem whose costs are CostTerms needs "
                  "`static constexpr std::array cost_names{...}`, a name for each term");
    if constexpr (names_costs<P>) {
      static_assert(std::size(P::cost_names) == named_terms<P>,
                    "slalom: the problem's cost_names must name each term of its CostTerms");
      for (int i = 0; i < named_terms<P>; ++i)
        terms[static_cast<std::size_t>(before + i)].name = P::cost_names[static_cast<std::size_t>(i)];
    }
  }
  return terms;
}
template <class P>
using CostTermsOf = decltype(cost_terms_of<P>());

/// Adds a cost to the terms it belongs to; `whole` is where a cost in one piece goes.
inline void add_terms(double cost, CostTerm* /*named*/, CostTerm& whole) noexcept {
  whole.value += cost;
}
inline void add_terms(const Cost<double>& cost, CostTerm* /*named*/, CostTerm& whole) noexcept {
  whole.value += cost.value;
}
template <int N>
void add_terms(const CostTerms<double, N>& cost, CostTerm* named, CostTerm& /*whole*/) noexcept {
  for (int i = 0; i < N; ++i) named[i].value += cost.value[i];
}

// --- bounds
/// One value for all inputs, or one for each.
inline double entry(double value, int /*input*/) noexcept {
  return value;
}
template <std::size_t N>
double entry(const std::array<double, N>& values, int input) noexcept {
  return values[static_cast<std::size_t>(input)];
}

template <class B, int N>
inline constexpr bool is_bound =
    std::is_convertible_v<B, double> || std::is_same_v<std::remove_cvref_t<B>, std::array<double, N>>;

template <class P>
inline constexpr bool has_input_min = requires(const P& p) {
  p.input_min;
};
template <class P>
inline constexpr bool has_input_max = requires(const P& p) {
  p.input_max;
};
template <class P>
inline constexpr bool limits_rates = requires(const P& p) {
  p.input_rate_max;
};

template <class P>
inline constexpr bool has_levels = requires(const P& p) {
  p.input_levels;
};
/// Whether rollouts carry a value for each input from step to step: the input before where rates are limited,
/// the remainder where inputs are in levels.
template <class P>
inline constexpr bool carries_inputs = limits_rates<P> || has_levels<P>;

/// Whether rollouts of a problem take packs in pairs (pack/pair.hpp).
template <class P>
inline constexpr bool has_long_steps = requires {
  requires P::long_steps;
};

/// Duration of a problem's step, s; 0 where it has none.
template <class P>
double time_step_of(const P& problem) noexcept {
  if constexpr (requires { problem.time_step(); }) {
    return static_cast<double>(problem.time_step());
  } else if constexpr (requires { static_cast<double>(problem.dt); }) {
    return static_cast<double>(problem.dt);
  } else {
    return 0;
  }
}

/// The bounds that a problem states for an input; infinite where it states none.
template <class P>
double min_input(const P& problem, int input) noexcept {
  if constexpr (has_input_min<P>) return entry(problem.input_min, input);
  return -std::numeric_limits<double>::infinity();
}
template <class P>
double largest_input(const P& problem, int input) noexcept {
  if constexpr (has_input_max<P>) return entry(problem.input_max, input);
  return std::numeric_limits<double>::infinity();
}

/// The bounds that a problem states. Throws std::invalid_argument if one of them is not a number, or if a
/// rate or the duration of a step is not a number or is negative. That `low` is at most `high` is left to the
/// solver, which knows all bounds.
template <class P>
InputBounds stated_bounds(const P& problem) {
  const auto require = [](bool holds, const char* what, double value, const char* rule) {
    if (!holds)
      throw std::invalid_argument("problem" + std::string(what) + ": " + std::to_string(value) + " must be " +
                                  rule);
  };
  InputBounds bounds(P::inputs);
  for (int i = 0; i < P::inputs; ++i) {
    const double low = min_input(problem, i), high = largest_input(problem, i);
    require(!std::isnan(low), ".input_min", low, "a number");
    require(!std::isnan(high), ".input_max", high, "a number");
    if constexpr (limits_rates<P>) {
      const double rate = entry(problem.input_rate_max, i);
      require(rate >= 0, ".input_rate_max", rate, "at least 0");
    }
    if constexpr (has_levels<P>) {
      const double levels = entry(problem.input_levels, i);
      require(levels == 0 || (levels >= 2 && levels <= 1e6 && levels == std::floor(levels)), ".input_levels",
              levels, "0 or a whole number from 2 to 1e6");
      require(levels == 0 || (high > low && std::isfinite(high - low)), ".input_max", high,
              "finite and above input_min where there are input_levels");
    }
    bounds.low[static_cast<std::size_t>(i)] = low;
    bounds.high[static_cast<std::size_t>(i)] = high;
  }
  const double step = time_step_of(problem);
  require(step >= 0 && std::isfinite(step), ": duration of a step", step, "finite and at least 0");
  return bounds;
}

/// Returns how far an input may move in a step.
template <class P>
double input_step(const P& problem, int input) noexcept {
  if constexpr (limits_rates<P>) return entry(problem.input_rate_max, input) * time_step_of(problem);
  return std::numeric_limits<double>::infinity();
}

/// Holds an input within reach of the one before, and keeps it as the next one's predecessor.
template <class T, int M>
SLALOM_INLINE void hold_rate(Input<T, M>& u, Input<T, M>& previous, const Input<T, M>& reach) {
  for (int i = 0; i < M; ++i) {
    u[i] = clamp(u[i], previous[i] - reach[i], previous[i] + reach[i]);
    previous[i] = u[i];
  }
}

/// The levels of each input: low, low + spacing ... high. An input with a spacing of 0 takes all values.
template <class T, int M>
struct Levels {
  Input<T, M> low, high, spacing, inverse;
};
template <class T, class P>
SLALOM_INLINE_CALLS Levels<T, P::inputs> levels_of(const P& problem) {
  Levels<T, P::inputs> levels;
  for (int i = 0; i < P::inputs; ++i) {
    const double low = min_input(problem, i), high = largest_input(problem, i),
                 count = entry(problem.input_levels, i);
    const double spacing = count >= 2 ? (high - low) / (count - 1) : 0;
    levels.low[i] = T(spacing > 0 ? low : 0);
    levels.high[i] = T(high);
    levels.spacing[i] = T(spacing);
    levels.inverse[i] = T(spacing > 0 ? 1 / spacing : 0);
  }
  return levels;
}

/// The unit of the variances of an input in levels, input^2: 0.03 of the squared distance between two of
/// them, since larger variances make it leave its level in most steps. 0 for other inputs.
template <class P>
double unit_variance(const P& problem, int input) noexcept {
  if constexpr (has_levels<P>) {
    const double spacing = levels_of<double>(problem).spacing[input];
    if (spacing > 0) return 0.03 * spacing * spacing;
  }
  return 0;
}

/// Replaces each input by the level nearest to it and the remainder of the step before, and keeps the new
/// remainder (error diffusion): the levels have the mean of the inputs.
template <class T, int M>
SLALOM_INLINE_CALLS void hold_levels(Input<T, M>& u, Input<T, M>& remainder, const Levels<T, M>& levels) {
  for (int i = 0; i < M; ++i) {
    const T spacing = levels.spacing[i], wanted = u[i] + remainder[i];
    const T nearest = levels.low[i] + round((wanted - levels.low[i]) * levels.inverse[i]) * spacing;
    const T level = select(spacing > T(0), clamp(nearest, levels.low[i], levels.high[i]), u[i]);
    remainder[i] = clamp(wanted - level, T(-0.5) * spacing, T(0.5) * spacing);
    u[i] = level;
  }
}

}  // namespace detail

/// Limits the rates of a control sequence u[step], in place, to the problem's `input_rate_max`, when
/// `previous` was applied before it, or moves the sequence to the problem's `input_levels`, where `previous`
/// is the remainder of the steps before. Changes nothing for a problem without them.
template <Problem P>
void hold_input_rates(const P& problem, Input<double, P::inputs> previous, Input<double, P::inputs>* u,
                      int steps) noexcept {
  if constexpr (detail::limits_rates<P>) {
    Input<double, P::inputs> reach;
    for (int i = 0; i < P::inputs; ++i) reach[i] = detail::input_step(problem, i);
    for (int k = 0; k < steps; ++k) detail::hold_rate(u[k], previous, reach);
  } else if constexpr (detail::has_levels<P>) {
    const auto levels = detail::levels_of<double>(problem);
    for (int k = 0; k < steps; ++k) detail::hold_levels(u[k], previous, levels);
  }
}

/// Moves the `remainder` of a problem with `input_levels` on by the first steps of a plan: by `wanted`
/// [step][input], the sequence of the method, less `held`, that in levels.
template <Problem P>
void carry_remainder(const P& problem, const float* wanted, const Input<double, P::inputs>* held, int steps,
                     Input<double, P::inputs>& remainder) noexcept {
  const auto levels = detail::levels_of<double>(problem);
  for (int k = 0; k < steps; ++k) {
    for (int i = 0; i < P::inputs; ++i, ++wanted) {
      const double left = remainder[i] + static_cast<double>(*wanted) - held[k][i],
                   most = levels.spacing[i] / 2;
      remainder[i] = std::clamp(left, -most, most);
    }
  }
}

}  // namespace slalom
