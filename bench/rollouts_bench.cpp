#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "slalom/core/instruction_set.hpp"

/// Rollouts of the vehicle problem on every instruction set and of the yardstick: ns_per_step on one core.
namespace slalom::workload {
namespace {

constexpr int samples = 8000;

const ReferenceWorkload& workload() {
  static const ReferenceWorkload made;
  return made;
}
const SequenceBatch& sequences() {
  static const SequenceBatch made = workload().sequences(samples);
  return made;
}
/// The costs of the yardstick, with which every rollout must agree.
const std::vector<double>& expected() {
  static const std::vector<double> made = [] {
    std::vector<double> costs(samples);
    workload().yardstick().evaluate(workload().start(), sequences(), samples, costs.data());
    return costs;
  }();
  return made;
}

void report(benchmark::State& state, int rollouts) {
  const double steps = static_cast<double>(rollouts) * ReferenceWorkload::steps;
  state.counters["ns_per_step"] = benchmark::Counter(
      steps * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void yardstick(benchmark::State& state) {
  const Yardstick stick = workload().yardstick();
  constexpr int count = 500;
  std::vector<double> costs(count);
  for (auto _ : state) stick.evaluate(workload().start(), sequences(), count, costs.data());
  if (costs != std::vector<double>(expected().begin(), expected().begin() + count))
    state.SkipWithError("the yardstick's costs differ");
  report(state, count);
}
BENCHMARK(yardstick);

template <bool two_trajectories>
void rollouts(benchmark::State& state, simd::Target target) {
  if (!simd::supported(target)) return state.SkipWithError("this processor lacks the instruction set");
  const auto model = workload().model(reference_problem(two_trajectories), target);
  const BatchEvaluator* const evaluator = &model->evaluator();
  AlignedBuffer costs(static_cast<std::size_t>(sequences().stride()));
  std::vector<std::uint8_t> collided(costs.size());
  for (auto _ : state) evaluator->evaluate(sequences(), 0, samples, costs.data(), collided.data());
  int other = 0;
  for (std::size_t k = 0; k < samples; ++k)
    other += std::abs(static_cast<double>(costs[k]) - expected()[k]) > 1e-3 * std::max(1.0, expected()[k]);
  // Rounding may move a state at the edge of a cell into the next one. The second trajectory starts with
  // straight wheels, so its costs differ.
  if (!two_trajectories && other > samples / 500) state.SkipWithError("costs differ from the yardstick's");
  report(state, samples);
}

void register_all() {
  for (const simd::Target target :
       {simd::Target::generic, simd::Target::sse4, simd::Target::avx2, simd::Target::avx512}) {
    const std::string name = simd::name(target);
    benchmark::RegisterBenchmark(("rollouts/" + name).c_str(), rollouts<false>, target);
    benchmark::RegisterBenchmark(("rollouts_two_trajectories/" + name).c_str(), rollouts<true>, target);
  }
}
const bool registered = (register_all(), true);

}  // namespace
}  // namespace slalom::workload
