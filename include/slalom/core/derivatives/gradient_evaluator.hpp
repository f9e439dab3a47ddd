#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "slalom/core/derivatives/cost_gradient.hpp"
#include "slalom/core/derivatives/linearize.hpp"
#include "slalom/core/problem_evaluator.hpp"

namespace slalom {

/// A problem with the exact gradients of its costs, for methods that use them beside samples
/// (`guide_gradient: exact` of `svg_mppi`). Everything else is as with the problem alone.
///
///     SvgMppiOptions options{.horizon = 40, .guides = {.gradient = GuideGradient::exact}};
///     Controller controller{GradientEvaluator{Pendulum{}}, options};
///
/// A gradient takes one evaluation of dynamics and costs over dual numbers for each step, in double, as long
/// as rollouts of many samples in SIMD lanes. A problem that limits the rates of its inputs has none, since
/// its rollouts do not take the inputs as they are.
template <Problem P>
class GradientEvaluator final : public BatchEvaluator, private CostGradient {
  static constexpr int nx = detail::state_size<P>, nu = P::inputs;

 public:
  using State = detail::StateOf<P, double>;  ///< the problem's state in double
  static constexpr int input_count = nu;     ///< inputs per step

  /// Uses the widest instruction set of the processor, or `target` if given.
  explicit GradientEvaluator(P problem, simd::Target target = simd::active_target())
      : batch_(std::move(problem), target) {}

  /// The problem, to change parameters between solves.
  P& problem() noexcept { return batch_.problem(); }
  /// The problem.
  const P& problem() const noexcept { return batch_.problem(); }

  /// Sets the state in which the next rollouts start.
  void set_state(const State& state) noexcept {
    batch_.set_state(state);
    start_ = state;
  }
  /// Sets the input that was applied before the next rollouts.
  void set_previous_input(const Input<double, nu>& u) noexcept requires detail::limits_rates<P> {
    batch_.set_previous_input(u);
  }

  int inputs() const noexcept override { return nu; }
  double time_step() const noexcept override { return batch_.time_step(); }
  const Sampler* sampler() const noexcept override { return batch_.sampler(); }
  const CostGradient* gradient() const noexcept override { return detail::limits_rates<P> ? nullptr : this; }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    batch_.evaluate(batch, first, count, costs, collided);
  }

  /// The states that a control sequence leads to, and its cost, in double.
  Cost<double> predict(const State& state, const Input<double, nu>* u, int steps, State* x) const noexcept {
    return slalom::predict(problem(), state, u, steps, x);
  }

 private:
  std::size_t workspace(int steps) const noexcept override { return static_cast<std::size_t>(steps) * nx; }

  /// The adjoint recursion: with l the cost of a step, its gradient by the inputs is l_u + B' p, where p, the
  /// gradient of the cost to go by the state, is l_x + A' p for the state before.
  GradientQuality differentiate(std::span<const float> sequence, std::span<double> workspace,
                                std::span<float> gradient) const noexcept override {
    const int steps = static_cast<int>(sequence.size()) / nu;
    const auto inputs_of = [&](int k) {
      Input<double, nu> u;
      std::copy_n(sequence.begin() + k * nu, nu, u.value);
      return u;
    };
    State x = start_;
    for (int k = 0; k < steps; ++k) {
      detail::scalars_of<P, double>(x, &workspace[static_cast<std::size_t>(k * nx)]);
      x = detail::step<P, double>(problem(), x, detail::look_up<P, double>(problem(), x), inputs_of(k), k);
    }
    double slope[nx];
    bool kink = terminal_gradient(x, slope), finite = true;
    for (int k = steps - 1; k >= 0; --k) {
      const State at = detail::state_of<P, double>(&workspace[static_cast<std::size_t>(k * nx)]);
      const auto l = linearize(problem(), at, inputs_of(k), k);
      kink = kink || l.kink;
      for (int i = 0; i < nu; ++i) {
        double sum = l.input_gradient[i];
        for (int row = 0; row < nx; ++row) sum += l.input_jacobian[row][i] * slope[row];
        const auto value = static_cast<float>(sum);
        finite = finite && std::isfinite(value);
        gradient[static_cast<std::size_t>(k * nu + i)] = value;
      }
      double before[nx];
      for (int i = 0; i < nx; ++i) {
        before[i] = l.state_gradient[i];
        for (int row = 0; row < nx; ++row) before[i] += l.state_jacobian[row][i] * slope[row];
      }
      std::copy_n(before, nx, slope);
    }
    if (!finite) return GradientQuality::not_finite;
    return kink ? GradientQuality::kink : GradientQuality::exact;
  }

  /// Writes the gradient of the terminal cost. Returns whether it has none there.
  bool terminal_gradient(const State& x, double (&slope)[nx]) const noexcept {
    using T = Dual<double, nx>;
    detail::check_differentiable<P, T>();
    double values[nx];
    T scalars[nx];
    detail::scalars_of<P, double>(x, values);
    detail::seed_directions(values, scalars);
    const auto state = detail::state_of<P, T>(scalars);
    const T cost = detail::total_of(
        detail::terminal_cost<P, T>(problem(), state, detail::look_up<P, T>(problem(), state)));
    std::copy_n(cost.derivative, nx, slope);
    return cost.kink;
  }

  ProblemEvaluator<P> batch_;
  State start_{};
};

}  // namespace slalom
