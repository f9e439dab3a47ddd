#pragma once

#include <cstring>

#include "slalom/core/derivatives/dual_math.hpp"
#include "slalom/core/problem_check.hpp"

/// Exact derivatives of a problem's dynamics and costs, from the functions that the problem has anyway.
namespace slalom {

/// A problem around a state x and inputs u, in first order. Scalars of a state are numbered in the order of
/// its members.
template <Problem P>
struct Linearization {
  static constexpr int states = detail::state_size<P>;  ///< scalars of a state
  static constexpr int inputs = P::inputs;              ///< inputs of a step

  detail::StateOf<P, double> next;        ///< step(x, u)
  double state_jacobian[states][states];  ///< A: derivative of next[row] by x[column]
  double input_jacobian[states][inputs];  ///< B: derivative of next[row] by u[column]
  double cost;                            ///< stage_cost(x, u)
  double state_gradient[states];          ///< derivative of the cost by x
  double input_gradient[inputs];          ///< derivative of the cost by u
  bool kink;  ///< whether a function has no derivative at x and u, see Dual; then A, B or the gradient hold
              ///< on one side at most
};

/// A cost around a state x and inputs u, in second order; `Inputs` is 0 for a terminal cost.
template <int States, int Inputs>
struct CostExpansion {
  /// Arrays of no elements are not C++: a terminal cost has one entry, which stays 0.
  static constexpr int rows = Inputs + (Inputs == 0 ? 1 : 0);

  double value;                          ///< the cost
  double state_gradient[States];         ///< derivative by x
  double state_hessian[States][States];  ///< second derivative by x
  double input_gradient[rows];           ///< derivative by u
  double input_hessian[rows][rows];      ///< second derivative by u
  double cross_hessian[rows][States];    ///< derivative by u[row] and x[column]
  bool kink;                             ///< whether a function has no derivative at x and u, see Dual
};

namespace detail {

template <class P, class T>
constexpr void check_differentiable() {
  static_assert(DeclaresStep<P, T> && DeclaresStageCost<P, T> && DeclaresTerminalCost<P, T>,
                "slalom: derivatives need the problem's functions for every T, also for slalom::Dual: "
                "overloads for double, float and Pack are not enough");
}

/// The scalars of a state as an array, and back.
template <class P, class T>
void scalars_of(const StateOf<P, T>& x, T (&values)[state_size<P>]) {
  static_assert(sizeof x == sizeof values);
  std::memcpy(static_cast<void*>(values), &x, sizeof x);
}
template <class P, class T>
StateOf<P, T> state_of(const T (&values)[state_size<P>]) {
  StateOf<P, T> x;
  static_assert(sizeof x == sizeof values);
  std::memcpy(static_cast<void*>(&x), values, sizeof x);
  return x;
}

/// The Hessian [States + Inputs][States + Inputs] of an expansion, row by row.
template <int States, int Inputs>
void copy_hessian(const CostExpansion<States, Inputs>& cost, double* to) {
  constexpr int all = States + Inputs;
  for (int i = 0; i < all; ++i) {
    for (int j = 0; j < all; ++j) {
      *to++ = i < States && j < States ? cost.state_hessian[i][j]
              : i < States             ? cost.cross_hessian[j - States][i]
              : j < States             ? cost.cross_hessian[i - States][j]
                                       : cost.input_hessian[i - States][j - States];
    }
  }
}

/// A cost without its collision.
template <class T>
T total_of(const T& cost) {
  return cost;
}
template <class T>
T total_of(const Cost<T>& cost) {
  return cost.value;
}
template <class T, int N>
T total_of(const CostTerms<T, N>& cost) {
  return sum_of(cost);
}

/// x and u as dual numbers with a direction for each of their scalars.
template <class P, class T, class Seed>
void seed_directions(const StateOf<P, double>& x, const InputOf<P, double>& u, T (&state)[state_size<P>],
                     InputOf<P, T>& input, Seed&& seed) {
  double values[state_size<P>];
  scalars_of<P, double>(x, values);
  for (int i = 0; i < state_size<P>; ++i) state[i] = seed(values[i], i);
  for (int i = 0; i < P::inputs; ++i) input[i] = seed(u[i], state_size<P> + i);
}

}  // namespace detail

/// Derivatives of the step and of the stage cost at a state and inputs, for step `k` of the horizon: exact to
/// rounding, by one evaluation over dual numbers. Does not allocate.
template <Problem P>
Linearization<P> linearize(const P& problem, const detail::StateOf<P, double>& x,
                           const Input<double, P::inputs>& u, int k = 0) {
  using L = Linearization<P>;
  constexpr int nx = L::states, nu = L::inputs;
  using T = Dual<double, nx + nu>;
  detail::check_differentiable<P, T>();
  T scalars[nx], next[nx];
  detail::InputOf<P, T> input;
  detail::seed_directions<P>(x, u, scalars, input, [](double value, int direction) {
    T r(value);
    r.derivative[direction] = 1;
    return r;
  });
  const auto state = detail::state_of<P, T>(scalars);
  const auto seen = detail::look_up<P, T>(problem, state);
  const T cost = detail::total_of(detail::stage_cost<P, T>(problem, state, seen, input, k));
  detail::scalars_of<P, T>(detail::step<P, T>(problem, state, seen, input, k), next);

  L result;
  double values[nx];
  result.cost = cost.value;
  result.kink = cost.kink;
  for (int row = 0; row < nx; ++row) {
    values[row] = next[row].value;
    result.kink = result.kink || next[row].kink;
    for (int i = 0; i < nx; ++i) result.state_jacobian[row][i] = next[row].derivative[i];
    for (int i = 0; i < nu; ++i) result.input_jacobian[row][i] = next[row].derivative[nx + i];
  }
  result.next = detail::state_of<P, double>(values);
  for (int i = 0; i < nx; ++i) result.state_gradient[i] = cost.derivative[i];
  for (int i = 0; i < nu; ++i) result.input_gradient[i] = cost.derivative[nx + i];
  return result;
}

/// First and second derivatives of the stage cost at a state and inputs, for step `k` of the horizon: exact
/// to rounding, by one evaluation for each row of the Hessian. Does not allocate.
template <Problem P>
CostExpansion<detail::state_size<P>, P::inputs> expand_stage_cost(const P& problem,
                                                                  const detail::StateOf<P, double>& x,
                                                                  const Input<double, P::inputs>& u,
                                                                  int k = 0) {
  constexpr int nx = detail::state_size<P>, nu = P::inputs;
  using First = Dual<double, 1>;
  using T = Dual<First, nx + nu>;
  detail::check_differentiable<P, T>();
  CostExpansion<nx, nu> result{};
  for (int row = 0; row < nx + nu; ++row) {
    T scalars[nx];
    detail::InputOf<P, T> input;
    detail::seed_directions<P>(x, u, scalars, input, [row](double value, int direction) {
      T r(value);
      r.derivative[direction] = 1;
      r.value.derivative[0] = direction == row;
      return r;
    });
    const auto state = detail::state_of<P, T>(scalars);
    const auto seen = detail::look_up<P, T>(problem, state);
    const T cost = detail::total_of(detail::stage_cost<P, T>(problem, state, seen, input, k));
    result.value = detail::plain(cost);
    result.kink = result.kink || detail::has_kink(cost);
    for (int i = 0; i < nx; ++i) {
      const double second = cost.derivative[i].derivative[0];
      (row < nx ? result.state_hessian[row][i] : result.cross_hessian[row - nx][i]) = second;
    }
    if (row < nx) {
      result.state_gradient[row] = cost.value.derivative[0];
    } else {
      result.input_gradient[row - nx] = cost.value.derivative[0];
      for (int i = 0; i < nu; ++i) result.input_hessian[row - nx][i] = cost.derivative[nx + i].derivative[0];
    }
  }
  return result;
}

/// First and second derivatives of the terminal cost at a state, as `expand_stage_cost`.
template <Problem P>
CostExpansion<detail::state_size<P>, 0> expand_terminal_cost(const P& problem,
                                                             const detail::StateOf<P, double>& x) {
  constexpr int nx = detail::state_size<P>;
  using First = Dual<double, 1>;
  using T = Dual<First, nx>;
  detail::check_differentiable<P, T>();
  CostExpansion<nx, 0> result{};
  double values[nx];
  detail::scalars_of<P, double>(x, values);
  for (int row = 0; row < nx; ++row) {
    T scalars[nx];
    for (int i = 0; i < nx; ++i) {
      scalars[i] = T(values[i]);
      scalars[i].derivative[i] = 1;
      scalars[i].value.derivative[0] = i == row;
    }
    const auto state = detail::state_of<P, T>(scalars);
    const auto seen = detail::look_up<P, T>(problem, state);
    const T cost = detail::total_of(detail::terminal_cost<P, T>(problem, state, seen));
    result.value = detail::plain(cost);
    result.kink = result.kink || detail::has_kink(cost);
    result.state_gradient[row] = cost.value.derivative[0];
    for (int i = 0; i < nx; ++i) result.state_hessian[row][i] = cost.derivative[i].derivative[0];
  }
  return result;
}

}  // namespace slalom
