// Time of the final check of a plan (core/final_check.hpp) with all that a controller and the planner check:
// inputs, cost and predicted states. A solve makes it once.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "slalom/core/final_check.hpp"

namespace {

constexpr std::size_t values_per_state = 8;

/// `state.range(0)` inputs over `state.range(1)` steps.
void final_check(benchmark::State& state) {
  const auto inputs = static_cast<std::size_t>(state.range(0)),
             steps = static_cast<std::size_t>(state.range(1));
  slalom::InputBounds bounds(static_cast<int>(inputs));
  bounds.low.assign(inputs, -0.4);
  bounds.high.assign(inputs, 0.4);
  std::vector<double> plan(inputs * steps), previous(inputs), states((steps + 1) * values_per_state, 1.5);
  for (std::size_t i = 0; i < plan.size(); ++i) plan[i] = 0.3 * std::sin(0.1 * static_cast<double>(i));
  double cost = 12;
  for (auto _ : state) {
    previous.assign(inputs, 0);
    int corrections = slalom::check_cost(cost);
    for (std::size_t k = 0; k < steps; ++k)
      corrections += slalom::check_inputs(std::span(plan).subspan(k * inputs, inputs), previous, bounds,
                                          [](std::size_t) { return 0.2; });
    for (const double value : states) corrections += !std::isfinite(value);
    benchmark::DoNotOptimize(corrections);
    benchmark::DoNotOptimize(plan.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(final_check)->Args({1, 14})->Args({1, 25})->Args({2, 40})->Args({7, 60});

}  // namespace
