#pragma once

#include <array>
#include <utility>

#include "slalom/core/network/mlp.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::python {

/// In place of a field. It has a value, since bytes between members would be copied to a GPU unset.
struct NoField {
  double unused = 0;
};

/// The problem of slalom.MlpProblem: the dynamics of a network and a cost of few parts. `Walls` and `Mapped`
/// are a slalom::maps::Field, or NoField.
template <int States, int Inputs, int Discs, class Walls, class Mapped>
struct NetworkStruct {
  template <class T>
  struct State {
    T value[States];
  };
  static constexpr int inputs = Inputs, unrolled_steps = 1;
  Mlp<States + Inputs, States> network;  ///< the state after a step, of state and inputs
  double dt = 0, disc_weight = 0;        ///< s; cost of a state that collides
  std::array<double, States> goal{}, state_weights{}, terminal_weights{};
  std::array<double, Inputs> input_weights{}, input_min{}, input_max{};
  std::array<double, 3 * Discs> discs{};   ///< x, y, radius of each, m
  Walls walls;                             ///< distance from the nearest wall, m
  Mapped field;                            ///< a part of the cost
  double clearance = 0, field_weight = 1;  ///< m: a state collides where `walls` is less; factor of `field`

  template <class V>
  void visit_memory(V&& visit) const {
    visit(network);
  }
  template <class T>
  State<T> step(const State<T>& x, const Input<T, Inputs>& u) const {
    const auto next = [&]<std::size_t... S, std::size_t... I>(std::index_sequence<S...>,
                                                              std::index_sequence<I...>) {
      return network(x.value[S]..., u[static_cast<int>(I)]...);
    }
    (std::make_index_sequence<States>(), std::make_index_sequence<Inputs>());
    State<T> after;
    for (int i = 0; i < States; ++i) after.value[i] = next[i];
    return after;
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, Inputs>& u) const {
    Cost<T> cost = state_cost(state_weights, x);
    for (int i = 0; i < Inputs; ++i)
      cost.value = cost.value + T(input_weights[static_cast<std::size_t>(i)]) * square(u[i]);
    return cost;
  }
  template <class T>
  Cost<T> terminal_cost(const State<T>& x) const {
    return state_cost(terminal_weights, x);
  }

 private:
  template <class T>
  Cost<T> state_cost(const std::array<double, States>& weights, const State<T>& x) const {
    T cost(0);
    for (std::size_t i = 0; i < States; ++i) cost = cost + T(weights[i]) * square(x.value[i] - T(goal[i]));
    mask_t<T> hit = mask_t<T>(false);
    if constexpr (Discs > 0) {
      for (std::size_t i = 0; i < 3 * Discs; i += 3)
        hit = hit || square(x.value[0] - T(discs[i])) + square(x.value[1] - T(discs[i + 1])) <
                         T(discs[i + 2] * discs[i + 2]);
    }
    if constexpr (requires(const Walls& w) { w.geometry(); })
      hit = hit || walls.value(x.value[0], x.value[1]) < T(clearance);
    if constexpr (requires(const Mapped& m) { m.geometry(); })
      cost = cost + T(field_weight) * field.value(x.value[0], x.value[1]);
    return {cost + select(hit, T(disc_weight), T(0)), hit};
  }
};

}  // namespace slalom::python
