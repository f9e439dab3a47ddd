// The comparison of Vlahov et al., "MPPI-Generic: A CUDA Library for Stochastic Trajectory Optimization"
// (2024): a differential-drive robot crosses a map with three discs; T = 100, dt = 0.02 s, K = 2^7 ... 2^14.
// Prints the mean time of a cycle (one solve) over a whole drive on one core, and the mean of each term of
// the cost. Exits with status 1 if a term is zero, since the measurement is then meaningless. Published means
// at K = 2048: 0.146 ms (RTX 4090), 0.84 ms (GTX 1050 Ti), 1.65 ms (Orin Nano); nav2's controller on the
// processor 6.7 ms (i9-13900K), 9.5 ms (Ryzen 5600X).
//   slalom_navigation_bench [cycles]

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "bench/problems.hpp"
#include "bench/workload/statistics.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/mppi_options.hpp"

namespace slalom {
namespace {

using bench::CostMap, bench::Navigation;

MppiOptions options_for(int samples) {
  MppiOptions o;
  o.horizon = 100;
  o.samples = samples;
  o.temperature = 1;
  o.variance = 0.2 * 0.2;
  o.input_min = {-0.35, -0.5};
  o.input_max = {0.5, 0.5};
  return o;
}

/// Drives half of the cycles from the start of the comparison, where there is no disc for some seconds, and
/// half from a position before the disc at (8, 8). Prints the result and returns whether no term of the cost
/// was zero.
bool drive(int samples, int cycles) {
  const CostMap map;
  Navigation problem;
  problem.map = map.view();
  ProblemEvaluator<Navigation> evaluator(problem);
  const auto solver = make_solver(options_for(samples), Navigation::inputs);
  Navigation::State<double> x{1, 1, 0};
  std::vector<double> times;
  std::array<double, 4> terms{};
  double collided = 0, sum = 0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    if (cycle == cycles / 2) x = {7.4, 7.4, std::atan2(1, 1)};
    evaluator.set_state(x);
    const auto begin = std::chrono::steady_clock::now();
    const SolveResult& result = solver->solve(evaluator, {.elapsed = problem.dt});
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    sum += times.back();
    collided += result.collided_share;
    const Input<double, 2> u{{static_cast<double>(result.inputs[0]), static_cast<double>(result.inputs[1])}};
    const double disc = problem.look_up(x);
    const CostTerms<double, 4> cost = problem.stage_cost(x, disc, u);
    for (std::size_t i = 0; i < 3; ++i) terms[i] += cost.value[i];
    x = problem.step(x, disc, u);
  }
  terms[3] = CostMap::disc_cost * collided;  // of the samples that collided: the robot itself should not
  const workload::TimeStatistics t = workload::time_statistics(times);
  const double cycle_ns = 1e6 * t.p50 / (static_cast<double>(samples) * 100);
  std::printf("K %6d  mean %.3f ms, p50 %.3f, min %.3f, max %.3f; %.2f ns a rollout step; terms", samples,
              sum / cycles, t.p50, t.min, t.max, cycle_ns);
  bool all = true;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    std::printf(" %s %.3g", Navigation::cost_names[i], terms[i]);
    all = all && terms[i] > 0;
  }
  std::printf("%s\n", all ? "" : ": ONE IS ZERO");
  return all;
}

}  // namespace
}  // namespace slalom

int main(int count, char** arguments) {
  const int cycles = count > 1 ? static_cast<int>(std::strtol(arguments[1], nullptr, 10)) : 400;
  bool all = true;
  for (int samples = 128; samples <= 16384; samples *= 2) all = slalom::drive(samples, cycles) && all;
  return all ? 0 : 1;
}
