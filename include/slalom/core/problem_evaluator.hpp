#pragma once

#include <cstring>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/dispatch.hpp"
#include "slalom/core/rollout.hpp"

namespace slalom {

/// Evaluates batches of a problem struct, at the full width of the processor it runs on.
template <Problem P>
class ProblemEvaluator final : public BatchEvaluator {
 public:
  using State = detail::StateOf<P, double>;

  explicit ProblemEvaluator(P problem, simd::Target target = simd::active_target())
      : problem_(std::move(problem)), rollout_(detail::rollout_function<P>(target)) {}

  /// The problem, to change parameters between solves.
  P& problem() noexcept { return problem_; }
  const P& problem() const noexcept { return problem_; }

  /// Where the next rollouts start.
  void set_state(const State& state) noexcept {
    double values[detail::state_size<P>];
    std::memcpy(values, &state, sizeof values);
    for (int i = 0; i < detail::state_size<P>; ++i) state_[i] = static_cast<float>(values[i]);
  }

  int inputs() const noexcept override { return P::inputs; }

  /// The problem's `time_step()` or `dt`, if it has one.
  double time_step() const noexcept override {
    if constexpr (requires { problem_.time_step(); }) {
      return static_cast<double>(problem_.time_step());
    } else if constexpr (requires { static_cast<double>(problem_.dt); }) {
      return static_cast<double>(problem_.dt);
    } else {
      return 0;
    }
  }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    rollout_(problem_, state_, batch, first, count, costs, collided);
  }

 private:
  P problem_;
  detail::RolloutFunction<P> rollout_;
  float state_[detail::state_size<P>] = {};
};

/// The predicted states of one control sequence, `steps` inputs u[step][input]: x[0] = `state` and the
/// `steps` that follow, in double. Returns the cost of the sequence in double, with its collision.
template <Problem P>
Cost<double> predict(const P& problem, const detail::StateOf<P, double>& state,
                     const Input<double, P::inputs>* u, int steps, detail::StateOf<P, double>* x) {
  Cost<double> cost{0.0, false};
  detail::StateOf<P, double> now = state;
  for (int k = 0; k < steps; ++k) {
    if (x) x[k] = now;
    const auto seen = detail::look_up<P, double>(problem, now);
    detail::accumulate<double>(detail::stage_cost<P, double>(problem, now, seen, u[k], k), cost.value,
                               cost.collided);
    now = detail::step<P, double>(problem, now, seen, u[k], k);
  }
  if (x) x[steps] = now;
  detail::accumulate<double>(
      detail::terminal_cost<P, double>(problem, now, detail::look_up<P, double>(problem, now)), cost.value,
      cost.collided);
  return cost;
}

}  // namespace slalom
