// A step of dynamics that a network has learned: two hidden layers of 32 neurons, in rollouts.

#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "slalom/core/network/mlp.hpp"
#include "slalom/core/problem_evaluator.hpp"

namespace slalom {
namespace {

constexpr int steps = 30, samples = 1024;

/// A car whose changes of speed, lateral speed and yaw rate are those of a network.
struct Learned {
  template <class T>
  struct State {
    T speed, lateral_speed, yaw_rate;
  };
  static constexpr int inputs = 2;
  Mlp<5, 3> network;

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    const auto next = network(x.speed, x.lateral_speed, x.yaw_rate, u[0], u[1]);
    return {next[0], next[1], next[2]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 2>&) const {
    return square(x.speed - T(1));
  }
  template <class T>
  T terminal_cost(const State<T>&) const {
    return T(0);
  }
};

MlpParameters random_parameters(Activation activation) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.2);
  MlpParameters p;
  p.activation = activation;
  p.residual = true;
  int entering = 5;
  for (const int neurons : {32, 32, 3}) {
    MlpParameters::Layer layer{entering, neurons, {}, {}};
    for (int i = 0; i < entering * neurons; ++i) layer.weights.push_back(normal(random));
    for (int i = 0; i < neurons; ++i) layer.biases.push_back(normal(random));
    p.layers.push_back(layer);
    entering = neurons;
  }
  return p;
}

/// Time of one step of one sample, for an activation and an instruction set.
void step_of_network(benchmark::State& state) {
  const auto target = static_cast<simd::Target>(state.range(1));
  if (!simd::supported(target)) return state.SkipWithError("this processor lacks the instruction set");
  const auto activation = static_cast<Activation>(state.range(0));
  constexpr const char* names[] = {"tanh", "relu", "softplus", "silu"};
  state.SetLabel(std::string(names[state.range(0)]) + ", " + simd::name(target));
  ProblemEvaluator<Learned> evaluator({Mlp<5, 3>(random_parameters(activation))}, target);
  SequenceBatch batch(steps, 2, samples);
  fill_normal(batch, 0, samples, RandomKey{1, 2});
  evaluator.set_state({1, 0, 0});
  AlignedBuffer costs(batch.stride());
  std::vector<std::uint8_t> collided(static_cast<std::size_t>(batch.stride()));
  for (auto _ : state) evaluator.evaluate(batch, 0, samples, costs.data(), collided.data());
  state.counters["s_per_step"] = benchmark::Counter(
      steps * samples, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(step_of_network)->ArgsProduct({{0, 1, 2, 3}, {0, 1, 2, 3}})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace slalom
