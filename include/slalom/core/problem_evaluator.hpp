#pragma once

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/dispatch.hpp"
#include "slalom/core/rollout.hpp"

namespace slalom {

namespace detail {

template <class P>
inline constexpr bool samples_itself = requires(const P& p, SequenceBatch& noise) {
  p.sample(noise, 0, 0, RandomKey{});
};

}  // namespace detail

/// Evaluates batches of a problem struct at the full vector width of the processor.
template <Problem P>
class ProblemEvaluator final : public BatchEvaluator, private Sampler {
 public:
  using State = detail::StateOf<P, double>;  ///< the problem's state in double

  /// Uses the widest instruction set of the processor, or `target` if given.
  explicit ProblemEvaluator(P problem, simd::Target target = simd::active_target())
      : problem_(std::move(problem)), rollout_(simd::kernel<detail::RolloutKernel<P>>(target)) {}

  /// The problem, to change parameters between solves.
  P& problem() noexcept { return problem_; }
  /// The problem.
  const P& problem() const noexcept { return problem_; }

  /// Sets the state in which the next rollouts start.
  void set_state(const State& state) noexcept {
    double values[detail::state_size<P>];
    std::memcpy(values, &state, sizeof values);
    for (int i = 0; i < detail::state_size<P>; ++i) state_[i] = static_cast<float>(values[i]);
  }

  /// Sets the input that was applied before the next rollouts, for a problem with `input_rate_max`, or the
  /// remainder for one with `input_levels`. Otherwise ignored.
  void set_previous_input(const Input<double, P::inputs>& u) noexcept {
    if constexpr (detail::carries_inputs<P>) {
      for (int i = 0; i < P::inputs; ++i) state_[detail::state_size<P> + i] = static_cast<float>(u[i]);
    }
  }

  /// The start of the next rollouts: the state, then the inputs applied before if the problem limits rates.
  std::span<const float> start() const noexcept { return state_; }

  int inputs() const noexcept override { return P::inputs; }

  /// The problem's `time_step()` or `dt`, if it has one.
  double time_step() const noexcept override { return detail::time_step_of(problem_); }

  /// The problem's `sample`, if it has one.
  const Sampler* sampler() const noexcept override {
    if constexpr (detail::samples_itself<P>) {
      return this;
    } else {
      return nullptr;
    }
  }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    rollout_(problem_, state_, batch, first, count, costs, collided);
  }

 private:
  void fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept override {
    if constexpr (detail::samples_itself<P>) problem_.sample(noise, first, count, key);
  }

  P problem_;
  simd::KernelPointer<detail::RolloutKernel<P>> rollout_;
  float state_[detail::start_size<P>] = {};
};

/// The terms of a problem's cost.
template <Problem P>
using CostTermsOf = detail::CostTermsOf<P>;

/// Predicts the states of a control sequence u[step][input] in double: x[0] is `state`, and x[1 ... steps]
/// follow. Returns the cost of the sequence and whether it collides, and writes the parts of the cost to
/// `terms`. `x` and `terms` may be null. Does not limit rates: see hold_input_rates.
template <Problem P>
Cost<double> predict(const P& problem, const detail::StateOf<P, double>& state,
                     const Input<double, P::inputs>* u, int steps, detail::StateOf<P, double>* x,
                     CostTermsOf<P>* terms = nullptr) {
  Cost<double> cost{0.0, false};
  CostTermsOf<P> parts = detail::cost_terms_of<P>();
  CostTerm* const named = parts.data() + (detail::terms_in<detail::StageCostOf<P>> == 0);
  detail::StateOf<P, double> now = state;
  for (int k = 0; k < steps; ++k) {
    if (x) x[k] = now;
    const auto seen = detail::look_up<P, double>(problem, now);
    const auto stage = detail::stage_cost<P, double>(problem, now, seen, u[k], k);
    detail::accumulate<double>(stage, cost.value, cost.collided);
    detail::add_terms(stage, named, parts.front());
    now = detail::step<P, double>(problem, now, seen, u[k], k);
  }
  if (x) x[steps] = now;
  const auto terminal =
      detail::terminal_cost<P, double>(problem, now, detail::look_up<P, double>(problem, now));
  detail::accumulate<double>(terminal, cost.value, cost.collided);
  detail::add_terms(terminal, named, parts.back());
  if (terms) *terms = parts;
  return cost;
}

}  // namespace slalom
