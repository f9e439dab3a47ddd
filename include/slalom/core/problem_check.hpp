#pragma once

#include "slalom/core/problem.hpp"

/// Says in words what a problem lacks, before the compiler says it in pages.
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
/// Wide, so that whatever else is in a state shows in its size.
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
concept DeclaresTerminalCost = requires(const P& p, const StateOf<P, T>& x) {
  p.terminal_cost(x);
}
|| looks_up<P, T>;

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
                  "slalom: the problem needs `template <class T> T terminal_cost(const State<T>& x) const`, "
                  "for every T, "
                  "and const");
    if constexpr (DeclaresStep<P, double>) {
      static_assert(StepsToState<P, double>, "slalom: the problem's step must return the State<T> of its T");
    }
  }
  return true;
}

}  // namespace slalom::detail
