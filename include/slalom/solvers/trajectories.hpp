#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "slalom/core/problem_evaluator.hpp"

namespace slalom {

/// Trajectories of control sequences, with the cost of each of their states by term.
struct Trajectories {
  std::vector<double> states;   ///< [sequence][horizon + 1][state]
  std::vector<double> costs;    ///< [sequence][horizon + 1][term]; the terms are those of `predict`
  std::vector<int> collisions;  ///< for each sequence the first of its states that collides; -1: none
};

/// Adds the trajectory of a control sequence from state `x`. Does not limit rates: see hold_input_rates.
template <Problem P>
void add_trajectory(Trajectories& all, const P& problem, detail::StateOf<P, double> x,
                    std::span<const Input<double, P::inputs>> inputs) {
  double sum = 0;
  bool collided = false;
  all.collisions.push_back(-1);
  const auto add_state = [&](int k, const auto& cost, bool is_last) {
    detail::CostTermsOf<P> terms = detail::cost_terms_of<P>();
    CostTerm* const named = terms.data() + (detail::terms_in<detail::StageCostOf<P>> == 0);
    detail::accumulate<double>(cost, sum, collided);
    detail::add_terms(cost, named, is_last ? terms.back() : terms.front());
    if (collided && all.collisions.back() < 0) all.collisions.back() = k;
    double values[detail::state_size<P>];
    std::memcpy(values, &x, sizeof values);
    all.states.insert(all.states.end(), std::begin(values), std::end(values));
    for (const CostTerm& term : terms) all.costs.push_back(term.value);
  };
  int k = 0;
  for (const Input<double, P::inputs>& u : inputs) {
    const auto seen = detail::look_up<P, double>(problem, x);
    add_state(k, detail::stage_cost<P, double>(problem, x, seen, u, k), false);
    x = detail::step<P, double>(problem, x, seen, u, k++);
  }
  const auto seen = detail::look_up<P, double>(problem, x);
  add_state(k, detail::terminal_cost<P, double>(problem, x, seen), true);
}

/// Returns the trajectories of control sequences [sequence][`steps`][input] from state `x`, with rates and
/// levels as in the rollouts of the last solve.
template <Problem P>
Trajectories roll_out(const ProblemEvaluator<P>& evaluator, const detail::StateOf<P, double>& x,
                      std::span<const float> sequences, int steps) {
  Trajectories all;
  std::vector<Input<double, P::inputs>> inputs(static_cast<std::size_t>(steps));
  Input<double, P::inputs> previous{};
  if constexpr (detail::carries_inputs<P>)
    for (int i = 0; i < P::inputs; ++i)
      previous[i] =
          static_cast<double>(evaluator.start()[static_cast<std::size_t>(detail::state_size<P> + i)]);
  const std::size_t size = inputs.size() * P::inputs;
  for (std::size_t at = 0; at + size <= sequences.size(); at += size) {
    for (std::size_t i = 0; i < size; ++i)
      inputs[i / P::inputs][static_cast<int>(i % P::inputs)] = static_cast<double>(sequences[at + i]);
    hold_input_rates(evaluator.problem(), previous, inputs.data(), steps);
    add_trajectory<P>(all, evaluator.problem(), x, inputs);
  }
  return all;
}

}  // namespace slalom
