#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <type_traits>
#include <utility>

#include "slalom/core/problem_check.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/controller_core.hpp"

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

/// Stands for the problem of an evaluator that has none: it states nothing of its inputs.
template <int N>
struct NoProblem {
  static constexpr int inputs = N;
};

/// Properties of the problem or the evaluator that a controller owns.
template <class P>
struct Controlled {
  static_assert(check_problem<P>());
  using Evaluator = ProblemEvaluator<P>;
  using State = StateOf<P, double>;
  static constexpr int inputs = P::inputs;
  static constexpr bool predicts = true;
  static constexpr bool has_problem = true;
  static constexpr auto cost_terms() { return cost_terms_of<P>(); }
  static const P& problem_of(const Evaluator& evaluator) noexcept { return evaluator.problem(); }
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
  static constexpr bool has_problem = requires(const E& e) { e.problem(); };
  static constexpr auto cost_terms() { return std::array<CostTerm, 1>{{{"total", 0}}}; }
  static decltype(auto) problem_of(const E& evaluator) noexcept {
    if constexpr (has_problem) {
      return evaluator.problem();
    } else {
      return NoProblem<inputs>{};
    }
  }
};

/// A control sequence in double as inputs, in the same memory.
template <int N>
std::span<Input<double, N>> as_inputs(std::span<double> sequence) noexcept {
  static_assert(sizeof(Input<double, N>) == N * sizeof(double));
  return {reinterpret_cast<Input<double, N>*>(sequence.data()), sequence.size() / N};
}
template <int N>
std::span<const Input<double, N>> as_inputs(std::span<const double> sequence) noexcept {
  return {reinterpret_cast<const Input<double, N>*>(sequence.data()), sequence.size() / N};
}

/// The problem or the evaluator `P`, as a ControllerCore needs it. `Base` is a ControlledProblem.
template <class P, class Base = ControlledProblem>
class ControlledEvaluator : public Base {
 public:
  using State = typename Controlled<P>::State;
  using Evaluator = typename Controlled<P>::Evaluator;
  static constexpr int input_count = Controlled<P>::inputs;

  explicit ControlledEvaluator(P problem) : evaluator_(std::move(problem)) {}

  Evaluator& evaluator() noexcept { return evaluator_; }
  const Evaluator& evaluator() const noexcept override { return evaluator_; }
  int inputs() const noexcept override { return input_count; }
  void set_state(std::span<const double> state) noexcept override {
    State x;
    std::memcpy(&x, state.data(), sizeof x);
    evaluator_.set_state(x);
  }
  int states() const noexcept override { return static_cast<int>(sizeof(State) / sizeof(double)); }
  bool advance([[maybe_unused]] std::span<double> state, [[maybe_unused]] std::span<const double> input,
               [[maybe_unused]] int k) const noexcept override {
    constexpr bool steps = Problem<P>;
    if constexpr (steps || Controlled<P>::predicts) {
      State x[2];
      U u;
      std::memcpy(&x[0], state.data(), sizeof x[0]);
      std::copy(input.begin(), input.end(), u.value);
      if constexpr (steps) {
        x[1] = step<P, double>(stated(), x[0], look_up<P, double>(stated(), x[0]), u, k);
      } else {
        State from = x[0];
        evaluator_.predict(from, &u, 1, x);
      }
      std::memcpy(state.data(), &x[1], sizeof x[1]);
    }
    return steps || Controlled<P>::predicts;
  }
  InputBounds stated_bounds() const override { return detail::stated_bounds(stated()); }
  double unit_variance(int input) const noexcept override { return detail::unit_variance(stated(), input); }
  double input_step(int input) const noexcept override { return detail::input_step(stated(), input); }
  bool in_levels() const noexcept override { return has_levels<Stated>; }
  void set_previous_input(std::span<const double> u) noexcept override {
    if constexpr (requires(Evaluator & e, const U& input) { e.set_previous_input(input); })
      evaluator_.set_previous_input(as_inputs<input_count>(u)[0]);
  }
  void hold_rates([[maybe_unused]] std::span<const double> previous,
                  [[maybe_unused]] std::span<double> sequence) const noexcept override {
    if constexpr (carries_inputs<Stated>) {
      const std::span<U> u = as_inputs<input_count>(sequence);
      hold_input_rates(stated(), as_inputs<input_count>(previous)[0], u.data(), static_cast<int>(u.size()));
    }
  }
  void carry([[maybe_unused]] std::span<const float> wanted, [[maybe_unused]] std::span<const double> held,
             [[maybe_unused]] std::span<double> remainder) const noexcept override {
    if constexpr (has_levels<Stated>) {
      const std::span<const U> u = as_inputs<input_count>(held);
      carry_remainder(stated(), wanted.data(), u.data(), static_cast<int>(u.size()),
                      as_inputs<input_count>(remainder)[0]);
    }
  }

 private:
  using U = Input<double, input_count>;

  decltype(auto) stated() const noexcept { return Controlled<P>::problem_of(evaluator_); }
  using Stated = std::remove_cvref_t<decltype(Controlled<P>::problem_of(std::declval<const Evaluator&>()))>;

  Evaluator evaluator_;
};

}  // namespace detail

}  // namespace slalom
