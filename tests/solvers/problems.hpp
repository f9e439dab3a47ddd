#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/problem_evaluator.hpp"

namespace slalom::testing {

/// A point that is pushed along a line towards the origin: linear dynamics, quadratic cost.
struct DoubleIntegrator {
  template <class T>
  struct State {
    T position, speed;
  };
  static constexpr int inputs = 1;  // acceleration
  double dt = 0.1;

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    return {x.position + T(dt) * x.speed, x.speed + T(dt) * u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>& u) const {
    return x.position * x.position + T(0.1) * x.speed * x.speed + T(0.1) * u[0] * u[0];
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(10) * x.position * x.position + x.speed * x.speed;
  }

  /// The optimal inputs from a state (Riccati recursion), which need no bounds if they are small.
  std::vector<double> optimum(State<double> x, int horizon) const {
    double a = 10, b = 0, c = 1;  // value function (a b; b c)
    std::vector<std::array<double, 2>> gain(static_cast<std::size_t>(horizon));
    for (int k = horizon - 1; k >= 0; --k) {
      const double denominator = 0.1 + dt * dt * c;
      const double k0 = dt * b / denominator, k1 = dt * (b * dt + c) / denominator;
      const double a00 = 1, a01 = dt, a10 = -dt * k0, a11 = 1 - dt * k1;
      const double na = 1 + 0.1 * k0 * k0 + a00 * (a * a00 + b * a10) + a10 * (b * a00 + c * a10);
      const double nb = 0.1 * k0 * k1 + a00 * (a * a01 + b * a11) + a10 * (b * a01 + c * a11);
      const double nc = 0.1 + 0.1 * k1 * k1 + a01 * (a * a01 + b * a11) + a11 * (b * a01 + c * a11);
      gain[static_cast<std::size_t>(k)] = {k0, k1};
      a = na;
      b = nb;
      c = nc;
    }
    std::vector<double> u;
    for (int k = 0; k < horizon; ++k) {
      const auto& g = gain[static_cast<std::size_t>(k)];
      u.push_back(-g[0] * x.position - g[1] * x.speed);
      x = step<double>(x, {{u.back()}});
    }
    return u;
  }
};

/// An evaluator made of a function of a batch and a sample, which returns the cost and whether it collides.
template <class Function>
class FunctionEvaluator final : public BatchEvaluator {
 public:
  FunctionEvaluator(int inputs, Function function) : inputs_(inputs), function_(std::move(function)) {}

  int inputs() const noexcept override { return inputs_; }
  double time_step() const noexcept override { return 0.05; }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    for (int k = first; k < first + count; ++k) {
      const auto [cost, hit] = function_(batch, k);
      costs[k] = static_cast<float>(cost);
      collided[k] = hit;
    }
  }

 private:
  int inputs_;
  Function function_;
};

/// An evaluator of sequences of one input, whose cost is the sum of cost(input, step) over the steps.
template <class Cost>
auto sum_over_steps(Cost cost) {
  return FunctionEvaluator(1, [cost](const SequenceBatch& batch, int k) {
    double sum = 0;
    for (int t = 0; t < batch.steps(); ++t) sum += cost(static_cast<double>(batch.at(t, 0, k)), t);
    return std::pair(sum, false);
  });
}

}  // namespace slalom::testing
