#pragma once

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

/// A cost in second order, by the scalars of a state x and then, for a stage cost, those of the inputs u.
template <int N>
struct CostExpansion {
  double value;          ///< the cost
  double gradient[N];    ///< first derivatives
  double hessian[N][N];  ///< second derivatives
  bool kink;             ///< whether a function has no derivative at x and u, see Dual
};

namespace detail {

template <class P, class T>
constexpr void check_differentiable() {
  static_assert(DeclaresStep<P, T> && DeclaresStageCost<P, T> && DeclaresTerminalCost<P, T>,
                "slalom: derivatives need the problem's functions for every T, also for slalom::Dual: "
                "overloads for double, float and Pack are not enough");
}

/// Writes the `state_size` scalars of a state.
template <class P, class T>
void scalars_of(const StateOf<P, T>& x, T* values) {
  static_assert(sizeof x == state_size<P> * sizeof(T));
  std::memcpy(static_cast<void*>(values), &x, sizeof x);
}
/// The state with these scalars.
template <class P, class T>
StateOf<P, T> state_of(const T* values) {
  StateOf<P, T> x;
  std::memcpy(static_cast<void*>(&x), values, sizeof x);
  return x;
}
/// The inputs with these values.
template <class P, class T>
InputOf<P, T> inputs_of(const T* values) {
  InputOf<P, T> u;
  std::copy_n(values, P::inputs, u.value);
  return u;
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

/// N numbers as dual numbers, with a direction for each.
template <class T, int N>
void seed_directions(const double (&values)[N], T (&seeded)[N]) {
  for (int i = 0; i < N; ++i) {
    seeded[i] = T(values[i]);
    seeded[i].derivative[i] = 1;
  }
}

/// Expands the cost `cost_of(numbers)` at N numbers, by one evaluation for each row of its Hessian.
template <int N, class CostOf>
CostExpansion<N> expand(const double (&values)[N], CostOf&& cost_of) {
  using T = Dual<Dual<double, 1>, N>;
  CostExpansion<N> result{};
  for (int row = 0; row < N; ++row) {
    T seeded[N];
    seed_directions(values, seeded);
    seeded[row].value.derivative[0] = 1;
    const T cost = cost_of(seeded);
    result.value = plain(cost);
    result.kink = result.kink || has_kink(cost);
    result.gradient[row] = cost.value.derivative[0];
    for (int i = 0; i < N; ++i) result.hessian[row][i] = cost.derivative[i].derivative[0];
  }
  return result;
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
  double values[nx + nu];
  detail::scalars_of<P, double>(x, values);
  std::copy_n(u.value, nu, values + nx);
  T seeded[nx + nu], next[nx];
  detail::seed_directions(values, seeded);
  const auto state = detail::state_of<P, T>(seeded);
  const auto input = detail::inputs_of<P, T>(seeded + nx);
  const auto seen = detail::look_up<P, T>(problem, state);
  const T cost = detail::total_of(detail::stage_cost<P, T>(problem, state, seen, input, k));
  detail::scalars_of<P, T>(detail::step<P, T>(problem, state, seen, input, k), next);

  L result;
  result.cost = cost.value;
  result.kink = cost.kink;
  for (int row = 0; row < nx; ++row) {
    values[row] = next[row].value;
    result.kink = result.kink || next[row].kink;
    std::copy_n(next[row].derivative, nx, result.state_jacobian[row]);
    std::copy_n(next[row].derivative + nx, nu, result.input_jacobian[row]);
  }
  result.next = detail::state_of<P, double>(values);
  std::copy_n(cost.derivative, nx, result.state_gradient);
  std::copy_n(cost.derivative + nx, nu, result.input_gradient);
  return result;
}

/// First and second derivatives of the stage cost at a state and inputs, for step `k` of the horizon: exact
/// to rounding, by one evaluation for each row of the Hessian. Does not allocate.
template <Problem P>
auto expand_stage_cost(const P& problem, const detail::StateOf<P, double>& x,
                       const Input<double, P::inputs>& u, int k = 0) {
  constexpr int nx = detail::state_size<P>, all = nx + P::inputs;
  using T = Dual<Dual<double, 1>, all>;
  detail::check_differentiable<P, T>();
  double values[all];
  detail::scalars_of<P, double>(x, values);
  std::copy_n(u.value, P::inputs, values + nx);
  auto result = detail::expand(values, [&](const T* seeded) {
    const auto state = detail::state_of<P, T>(seeded);
    const auto seen = detail::look_up<P, T>(problem, state);
    return detail::total_of(
        detail::stage_cost<P, T>(problem, state, seen, detail::inputs_of<P, T>(seeded + nx), k));
  });
  for (int i = 0; i < nx; ++i)  // the same in both orders, also in its last bit
    for (int j = nx; j < all; ++j) result.hessian[i][j] = result.hessian[j][i];
  return result;
}

/// First and second derivatives of the terminal cost at a state, as `expand_stage_cost`.
template <Problem P>
auto expand_terminal_cost(const P& problem, const detail::StateOf<P, double>& x) {
  using T = Dual<Dual<double, 1>, detail::state_size<P>>;
  detail::check_differentiable<P, T>();
  double values[detail::state_size<P>];
  detail::scalars_of<P, double>(x, values);
  return detail::expand(values, [&](const T* seeded) {
    const auto state = detail::state_of<P, T>(seeded);
    const auto seen = detail::look_up<P, T>(problem, state);
    return detail::total_of(detail::terminal_cost<P, T>(problem, state, seen));
  });
}

}  // namespace slalom
