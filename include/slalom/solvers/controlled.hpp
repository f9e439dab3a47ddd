#pragma once

#include <array>
#include <concepts>
#include <type_traits>

#include "slalom/core/problem_check.hpp"
#include "slalom/core/problem_evaluator.hpp"

namespace slalom {

/// A batch evaluator that a `Controller` can own in place of a problem: one that evaluates batches on a GPU,
/// in a physics engine or by hand-written loops. In addition to the functions of `BatchEvaluator` it has
///
///     struct State { double x, y, yaw; };               // `double` members only
///     static constexpr int input_count = 2;             // result of inputs()
///     void set_state(const State&);                     // start of the next sequences
///
/// and may have
///
///     Cost<double> predict(const State&, const Input<double, 2>* u, int steps, State* x) const;
///                                                       // x[0 ... steps] and the cost of one sequence
///     void set_previous_input(const Input<double, 2>&); // input before the next sequences
///     const MyProblem& problem() const;                 // gives bounds and rates, as in RiskEvaluator
template <class E>
concept StateEvaluator = std::derived_from<E, BatchEvaluator> && requires(E& e, const typename E::State& x) {
  requires sizeof(typename E::State) % sizeof(double) == 0;
  requires(std::is_trivially_copyable_v<typename E::State> && E::input_count > 0);
  e.set_state(x);
};

namespace detail {

/// Properties of the problem or the evaluator that a controller owns.
template <class P>
struct Controlled {
  static_assert(check_problem<P>());
  static_assert(HasTimeStep<P> ||
                    !(
                        requires { &P::ts; } || requires { &P::Ts; } || requires { &P::delta_t; } ||
                        requires { &P::timestep; } || requires { &P::time_step; }),
                "slalom: the problem's duration of a step must be `dt`, or the result of `time_step()`");
  using Evaluator = ProblemEvaluator<P>;
  using State = StateOf<P, double>;
  static constexpr int inputs = P::inputs;
  static constexpr bool predicts = true;
  static constexpr bool uses_previous_input = carries_inputs<P>;
  static constexpr bool in_levels = has_levels<P>;
  static constexpr bool has_problem = true;
  static constexpr auto cost_terms() { return cost_terms_of<P>(); }
};

template <StateEvaluator E>
struct Controlled<E> {
  using Evaluator = E;
  using State = typename E::State;
  static constexpr int inputs = E::input_count;
  static constexpr bool predicts =
      requires(const E& e, const State& x, const Input<double, inputs>* u, State* states) {
    { e.predict(x, u, 1, states) } -> std::convertible_to<Cost<double>>;
  };
  static constexpr bool uses_previous_input = requires(E & e, const Input<double, inputs>& u) {
    e.set_previous_input(u);
  };
  static constexpr bool has_problem = requires(const E& e) { e.problem(); };
  static constexpr bool in_levels = requires(const E& e) { e.problem().input_levels; };
  static constexpr auto cost_terms() { return std::array<CostTerm, 1>{{{"total", 0}}}; }
};

}  // namespace detail

}  // namespace slalom
