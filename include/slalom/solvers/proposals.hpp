#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "slalom/solvers/controller.hpp"

namespace slalom {

namespace detail {

/// Gives the inputs for a state and a step of the horizon.
template <class Law, class C>
concept ControlLaw = C::has_problem &&
    std::convertible_to<std::invoke_result_t<Law&, const typename C::State&, int>, Input<double, C::inputs>>;

}  // namespace detail

/// Control sequences of other controllers that compete with the samples of a solve: a brake, a regulator, the
/// output of a network (Biased-MPPI: Trevisan and Alonso-Mora, IEEE RA-L 9(6), 2024). A good proposal helps
/// where the method's own samples rarely are good.
///
///     slalom::Proposals proposals{controller, 2};                          // room for two; allocates
///     proposals.clear();
///     proposals.follow(controller, x, [](const auto& x, int) { return brake(x); });
///     proposals.add(inputs_of_a_network);
///     const auto plan = controller.solve(x, {.elapsed = 0.05, .proposals = proposals});
///
/// With K samples and n proposals, proposal i is sample K - n + i of `mppi` and `dial_mpc`, so its weight in
/// `plan.stats` tells how much it counted, unless `mppi` takes the best as nominal. `cem` and `icem` have it
/// in their first iteration, and `svg_mppi` takes it as a guide (docs/algorithms/risk-and-proposals.md).
template <class P>
class Proposals {
  using Controlled = detail::Controlled<P>;

 public:
  using State = typename Controlled::State;          ///< the problem's state in double
  using Inputs = Input<double, Controlled::inputs>;  ///< inputs of a step

  /// Room for `capacity` sequences for the solver of `controller`. Throws std::invalid_argument if its method
  /// takes no proposals or `capacity` is below 1. Nothing else here allocates or throws.
  Proposals(const Controller<P>& controller, int capacity)
      : steps_(controller.solver().horizon()), capacity_(capacity), bounds_(controller.bounds()) {
    const Solver& solver = controller.solver();
    if (!solver.takes_proposals())
      throw std::invalid_argument("proposals: the method " + std::string(solver.name()) +
                                  " does not accept proposals");
    if (capacity < 1)
      throw std::invalid_argument("proposals: capacity " + std::to_string(capacity) + " must be at least 1");
    values_.resize(static_cast<std::size_t>(capacity) * static_cast<std::size_t>(steps_ * solver.inputs()));
  }

  /// Removes all sequences.
  void clear() noexcept { count_ = 0; }
  /// The number of sequences.
  int size() const noexcept { return count_; }

  /// Adds a control sequence, moved into the bounds. If it is shorter than the horizon, its last inputs are
  /// held. Returns false, and adds nothing, if there is no room or the sequence is empty.
  bool add(std::span<const Inputs> inputs) noexcept {
    if (inputs.empty() || count_ == capacity_) return false;
    for (int k = 0; k < steps_; ++k) put(k, inputs[std::min(static_cast<std::size_t>(k), inputs.size() - 1)]);
    ++count_;
    return true;
  }

  /// Adds the inputs of a control law from state `x`: `law(state, step)` at each step of the horizon,
  /// moved into the bounds, with the states that the controller's problem predicts for them. Limits on rates
  /// are not applied. Returns false, and adds nothing, if there is no room.
  template <detail::ControlLaw<Controlled> Law>
  bool follow(const Controller<P>& controller, const State& x, Law&& law) noexcept {
    if (count_ == capacity_) return false;
    const auto& problem = controller.problem();
    using Problem = std::remove_cvref_t<decltype(problem)>;
    State now = x;
    for (int k = 0; k < steps_; ++k) {
      const Inputs u = put(k, law(now, k));
      now = detail::step<Problem, double>(problem, now, detail::look_up<Problem, double>(problem, now), u, k);
    }
    ++count_;
    return true;
  }

  /// The sequences, for `SolveRequest::proposals`; valid until one is added or removed.
  operator SequenceList() const noexcept { return {values_, count_}; }

 private:
  /// Writes the inputs of step `k` of the next sequence. Returns them, moved into the bounds.
  Inputs put(int k, Inputs u) noexcept {
    float* const to = values_.data() + static_cast<std::ptrdiff_t>(count_ * steps_ + k) * Controlled::inputs;
    for (int i = 0; i < Controlled::inputs; ++i) {
      u[i] = bounds_.nearest(static_cast<std::size_t>(i), u[i]);
      to[i] = static_cast<float>(u[i]);
    }
    return u;
  }

  int steps_;
  int capacity_;
  int count_ = 0;
  InputBounds bounds_;
  std::vector<float> values_;  ///< [sequence][step][input]
};

template <class P>
Proposals(const Controller<P>&, int) -> Proposals<P>;

}  // namespace slalom
