// A step of dynamics that a network has learned: two hidden layers of 32 neurons, in rollouts.

#include <benchmark/benchmark.h>

#include <vector>

#include "bench/random_network.hpp"
#include "slalom/core/problem_evaluator.hpp"

namespace slalom {
namespace {

using bench::Learned;

constexpr int steps = 30, samples = 1024;

/// Time of one step of one sample, for an activation and an instruction set.
void step_of_network(benchmark::State& state) {
  const auto target = static_cast<simd::Target>(state.range(1));
  if (!simd::supported(target)) return state.SkipWithError("this processor lacks the instruction set");
  const auto activation = static_cast<Activation>(state.range(0));
  constexpr const char* names[] = {"tanh", "relu", "softplus", "silu"};
  state.SetLabel(std::string(names[state.range(0)]) + ", " + simd::name(target));
  ProblemEvaluator<Learned> evaluator({bench::random_network(activation)}, target);
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
