#pragma once

#include "slalom/core/problem_parts.hpp"

/// Names the parts that a problem lacks, before the compiler does so in pages.
namespace slalom::detail {

// clang-format off
template <class P>
concept HasState = requires { typename P::template State<double>; typename P::template State<float>; };
template <class P>
concept HasInputs = requires {
    { P::inputs } -> std::convertible_to<int>; requires std::bool_constant<(P::inputs > 0)>::value; };
/// Wide, so that every other member of a state shows in its size.
struct StateProbe {
  char bytes[64];
};
template <class P>
concept StateHoldsOnlyT =
    std::is_trivially_copyable_v<StateOf<P, double>> && sizeof(StateOf<P, double>) % sizeof(double) == 0 &&
    sizeof(StateOf<P, StateProbe>) == sizeof(StateOf<P, double>) / sizeof(double) * sizeof(StateProbe);

template <class P>
concept HasTimeStep =
    requires(const P& p) { p.time_step(); } || requires(const P& p) { static_cast<double>(p.dt); };

/// The ways in which a function may be declared, tried without its body.
template <class P, class T>
concept DeclaresStep = looks_up<P, T> ||
    requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) { p.step(x, u); } ||
    requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) { p.step(x, u, 0); };
template <class P, class T>
concept StepsToState = looks_up<P, T> ||
    requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
      { p.step(x, u) } -> std::same_as<StateOf<P, T>>; } ||
    requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) {
      { p.step(x, u, 0) } -> std::same_as<StateOf<P, T>>; };
template <class P, class T>
concept DeclaresStageCost = looks_up<P, T> ||
    requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) { p.stage_cost(x, u); } ||
    requires(const P& p, const StateOf<P, T>& x, const InputOf<P, T>& u) { p.stage_cost(x, u, 0); };
template <class P, class T>
concept DeclaresTerminalCost = LacksTerminalCost<P> || looks_up<P, T> ||
    requires(const P& p, const StateOf<P, T>& x) { p.terminal_cost(x); };

/// Names that a slip, or another program, gives to an optional part, which would be left out without a word.
#define SLALOM_NEAR_NAMES(of)                                                                                \
  of(terminalCost, terminal_cost) of(terminal_costs, terminal_cost) of(final_cost, terminal_cost)             \
  of(u_min, input_min) of(umin, input_min) of(min_input, input_min) of(u_max, input_max) of(umax, input_max)  \
  of(max_input, input_max) of(input_rate, input_rate_max) of(rate_max, input_rate_max)                        \
  of(input_level, input_levels) of(lookup, look_up) of(lookUp, look_up) of(randomise, randomize)              \
  of(sampler, sample) of(long_step, long_steps) of(ts, dt) of(Ts, dt) of(h, dt) of(DT, dt) of(delta_t, dt)    \
  of(timestep, dt) of(time_step, dt)
#define SLALOM_DECLARE(name, part) int name;
struct NearNames { SLALOM_NEAR_NAMES(SLALOM_DECLARE) };
/// As with TerminalCostProbe, a name that the problem has, too, is ambiguous.
template <class P>
struct NearNamesProbe : std::conditional_t<std::is_final_v<P>, NoLookUp, P>, NearNames {};

/// The optional members of a problem, besides dynamics and costs.
template <class P>
constexpr void check_parts() {
  constexpr bool terminal_cost = !LacksTerminalCost<P>, dt = HasTimeStep<P>, look_up = looks_up<P, double>,
                 input_min = has_input_min<P>, input_max = has_input_max<P>, input_rate_max = limits_rates<P>,
                 input_levels = has_levels<P>, randomize = requires { &P::randomize; },
                 sample = requires { &P::sample; }, long_steps = requires { P::long_steps; };
#define SLALOM_REFUSE(name, part)                               \
  static_assert(part || requires { &NearNamesProbe<P>::name; }, \
                "slalom: the problem's " #name " would be ignored: this part must be named " #part);
  SLALOM_NEAR_NAMES(SLALOM_REFUSE)
#define SLALOM_CHECK_BOUND(name)                                            \
  if constexpr (name) static_assert(is_bound<decltype(P::name), P::inputs>, \
      "slalom: the problem's " #name " must be a double or a std::array<double, inputs>");
  SLALOM_CHECK_BOUND(input_min) SLALOM_CHECK_BOUND(input_max)
  SLALOM_CHECK_BOUND(input_rate_max) SLALOM_CHECK_BOUND(input_levels)
  static_assert(!input_rate_max || dt,
                "slalom: a problem with input_rate_max needs the duration of its step, `dt` or `time_step()`");
  static_assert(!input_levels || (input_min && input_max && !input_rate_max),
                "slalom: a problem with input_levels needs input_min and input_max, and no input_rate_max");
  static_cast<void>(cost_terms_of<P>());
}
#undef SLALOM_NEAR_NAMES
#undef SLALOM_DECLARE
#undef SLALOM_REFUSE
#undef SLALOM_CHECK_BOUND
// clang-format on

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
    static_assert(!DeclaresStep<P, double> || StepsToState<P, double>,
                  "slalom: the problem's step must return the State<T> of its T");
  }
  if constexpr (Problem<P>) check_parts<P>();
  return true;
}

}  // namespace slalom::detail
