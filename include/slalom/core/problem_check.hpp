#pragma once

#include "slalom/core/problem_parts.hpp"

/// Names the parts that a problem lacks, before the compiler does so in pages.
namespace slalom::detail {

template <class P>
concept HasState = requires {
  typename P::template State<double>;
  typename P::template State<float>;
};
template <class P>
concept HasInputs = requires {
  { P::inputs } -> std::convertible_to<int>;
  requires std::bool_constant<(P::inputs > 0)>::value;
};
/// Wide, so that every other member of a state shows in its size.
struct StateProbe {
  char bytes[64];
};
template <class P>
concept StateHoldsOnlyT =
    std::is_trivially_copyable_v<StateOf<P, double>> && sizeof(StateOf<P, double>) % sizeof(double) == 0 &&
    sizeof(StateOf<P, StateProbe>) == sizeof(StateOf<P, double>) / sizeof(double) * sizeof(StateProbe);

/// The ways in which a function may be declared, tried without its body.
template <class P, class T>
concept DeclaresStep = requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
  p.step(x, u);
}
|| requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
  p.step(x, u, 0);
}
|| looks_up<P, T>;
template <class P, class T>
concept StepsToState = requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
  { p.step(x, u) } -> std::same_as<StateOf<P, T>>;
}
|| requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
  { p.step(x, u, 0) } -> std::same_as<StateOf<P, T>>;
}
|| looks_up<P, T>;
template <class P, class T>
concept DeclaresStageCost = requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
  p.stage_cost(x, u);
}
|| requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
  p.stage_cost(x, u, 0);
}
|| looks_up<P, T>;
template <class P, class T>
concept DeclaresTerminalCost = LacksTerminalCost<P> || requires(const P& p, const StateOf<P, T>& x) {
  p.terminal_cost(x);
} || looks_up<P, T>;

template <class P>
concept InputMinFits = !has_input_min<P> || is_bound<decltype(P::input_min), P::inputs>;
template <class P>
concept InputMaxFits = !has_input_max<P> || is_bound<decltype(P::input_max), P::inputs>;
template <class P>
concept InputRateFits = !limits_rates<P> || is_bound<decltype(P::input_rate_max), P::inputs>;
template <class P>
concept InputLevelsFit = !has_levels<P> || is_bound<decltype(P::input_levels), P::inputs>;
template <class P>
concept HasTimeStep = requires(const P& p) {
  p.time_step();
}
|| requires(const P& p) {
  static_cast<double>(p.dt);
};

/// The optional members of a problem, besides dynamics and costs.
template <class P>
constexpr void check_parts() {
  static_assert(InputMinFits<P>,
                "slalom: the problem's input_min must be a double or a std::array<double, inputs>");
  static_assert(InputMaxFits<P>,
                "slalom: the problem's input_max must be a double or a std::array<double, inputs>");
  static_assert(InputRateFits<P>,
                "slalom: the problem's input_rate_max must be a double or a std::array<double, inputs>");
  static_assert(
      !limits_rates<P> || HasTimeStep<P>,
      "slalom: a problem with input_rate_max needs the duration of its step, `dt` or `time_step()`");
  static_assert(InputLevelsFit<P>,
                "slalom: the problem's input_levels must be a double or a std::array<double, inputs>");
  static_assert(!has_levels<P> || (has_input_min<P> && has_input_max<P> && !limits_rates<P>),
                "slalom: a problem with input_levels needs input_min and input_max, and no input_rate_max");
  static_cast<void>(cost_terms_of<P>());
}

template <class P>
constexpr bool check_problem() {
  static_assert(HasState<P>, "slalom: the problem needs `template <class T> struct State { T ...; };`");
  static_assert(HasInputs<P>, "slalom: the problem needs `static constexpr int inputs = ...;`, at least 1");
  if constexpr (HasState<P> && HasInputs<P>) {
    static_assert(StateHoldsOnlyT<P>,
                  "slalom: every member of the problem's State<T> must be a T or an array of them");
    static_assert(DeclaresStep<P, double> && DeclaresStep<P, float>,
                  "slalom: the problem needs `template <class T> State<T> step(const State<T>& x, const "
                  "slalom::Input<T, inputs>& u) const`, for every T, and const");
    static_assert(DeclaresStageCost<P, double> && DeclaresStageCost<P, float>,
                  "slalom: the problem needs `template <class T> T stage_cost(const State<T>& x, const "
                  "slalom::Input<T, inputs>& u) const`, for every T, and const");
    static_assert(DeclaresTerminalCost<P, double> && DeclaresTerminalCost<P, float>,
                  "slalom: the problem's terminal_cost must be `template <class T> T terminal_cost(const "
                  "State<T>& x) const`, for every T, and const");
    if constexpr (DeclaresStep<P, double>) {
      static_assert(StepsToState<P, double>, "slalom: the problem's step must return the State<T> of its T");
    }
  }
  if constexpr (Problem<P>) check_parts<P>();
  return true;
}

}  // namespace slalom::detail
