#pragma once

#include <cstdint>
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

/// The control sequence of a sample [row].
inline std::vector<float> sequence(const SequenceBatch& batch, int sample) {
  std::vector<float> values(batch.rows());
  batch.get_sample(sample, values);
  return values;
}

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
