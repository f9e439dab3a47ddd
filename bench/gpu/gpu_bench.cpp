// slalom_gpu_bench [brief]: compares first plans on a GPU with the processor's and times both, a row of CSV
// for each problem. With `brief`, for compute-sanitizer, few solves on the GPU alone.

#include <chrono>
#include <cstdio>
#include <string_view>

#include "bench/problems.hpp"
#include "bench/workload/statistics.hpp"
#include "slalom/gpu/gpu.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom::bench {
namespace {

using problems::Pendulum, problems::Quadrotor, workload::TimeStatistics;

constexpr int most = 131072;
bool brief = false;
int failed = 0;  ///< how many first plans differ from the processor's

/// Times solves in a closed loop, from the state to the plan; ms.
template <class P>
TimeStatistics time_loop(ProblemEvaluator<P>& evaluator, Solver& solver,
                         const typename P::template State<double>& start, double limit) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  const auto end = Clock::now() + std::chrono::duration<double>(limit);
  typename P::template State<double> states[2];
  for (int n = 0; n < (brief ? 1 : 1000) && (n < 8 || Clock::now() < end); ++n) {
    const auto begin = Clock::now();
    evaluator.set_state(n % 400 == 0 ? start : states[1]);
    const SolveResult& result = solver.solve(evaluator, {.elapsed = evaluator.time_step()});
    times.push_back(1e3 * std::chrono::duration<double>(Clock::now() - begin).count());
    Input<double, P::inputs> u;
    for (int i = 0; i < P::inputs; ++i) u[i] = result.inputs[static_cast<std::size_t>(i)];
    predict(evaluator.problem(), n % 400 == 0 ? start : states[1], &u, 1, states);
  }
  return workload::time_statistics(times);
}

/// Prints a row. `flops` of a step are counted by hand; `asked` are the wanted times, ms.
template <class P, class Options>
void compare(const char* name, const P& problem, const typename P::template State<double>& start,
             double flops, Options options, const char* asked = "") {
  ProblemEvaluator<P> evaluator(problem);
  evaluator.set_state(start);
  gpu::GpuSolver<P, Options> gpu(problem, options);
  gpu.connect(evaluator);
  const auto first = gpu.solve(evaluator, {}).inputs;
  const auto processor = make_solver(options, P::inputs);
  const auto expected = processor->solve(evaluator, {}).inputs;
  float difference = 0;
  for (std::size_t r = 0; r < first.size(); ++r)
    difference = std::max(difference, std::abs(first[r] - expected[r]));
  const TimeStatistics times = time_loop(evaluator, gpu, start, 5);
  const bool good = difference < 1e-3f && gpu.fault().empty();
  failed += !good;
  std::printf("%s,%s,%d,%.1e,%.4f,%.4f,%.2f", name, Options::method, options.samples, difference, times.p50,
              times.p99, flops * options.samples * options.horizon / times.p50 * 1e-9);
  for (const int threads : {16, 1}) {
    if (brief) break;
    options.threads = threads;
    std::printf(",%.4f", time_loop(evaluator, *make_solver(options, P::inputs), start, 0.4).p50);
  }
  std::printf(",%s%s%s\n", asked, good ? "" : " FAILED ", gpu.fault().c_str());
  std::fflush(stdout);
}

/// Guides as in the paper; a GPU draws one batch of white noise, and its temperatures are fixed.
SvgMppiOptions guided(int horizon, int samples, double temperature, const PerInput& low,
                      const PerInput& high) {
  SvgMppiOptions o{.horizon = horizon, .samples = samples, .batches = 1, .temperature = temperature};
  o.input_min = low, o.input_max = high;
  o.noise.exponent = 0;
  o.guides.gradient_temperature = 1;
  o.guides.count = 4, o.guides.iterations = 10, o.guides.gradient_samples = 25;
  return o;
}

void run() {
  std::puts("problem,method,samples,difference of first plan,GPU ms,99 %,TFLOP/s,16 threads,1 thread,asked");
  const CostMap map;
  Navigation navigation{.map = map.view()};
  const PerInput low{-0.35, -0.5}, high{0.5, 0.5};
  const auto navigate = [&](int samples, const char* asked = "") {
    compare("navigation", navigation, {7.4, 7.4, 0.785398}, 45,
            MppiOptions{.horizon = brief ? 10 : 100,
                        .samples = samples,
                        .temperature = 1,
                        .variance = 0.04,
                        .input_min = low,
                        .input_max = high},
            asked);
  };
  const auto navigate_guided = [&](int samples, const char* asked) {
    SvgMppiOptions o = guided(brief ? 10 : 100, samples, 1, low, high);
    o.variance_min = 0.01, o.variance_max = 0.04;
    o.guides.gradient_variance = o.guides.variance = o.guides.restart_variance = 0.04, o.guides.step = 0.02;
    compare("navigation", navigation, {7.4, 7.4, 0.785398}, 45, o, asked);
  };
  const auto learn = [](int samples, const char* asked) {
    compare("network", Learned{random_network()}, {1, 0, 0}, 2 * 1280 + 64 * 8,
            MppiOptions{.horizon = 50,
                        .samples = samples,
                        .temperature = 1,
                        .variance = 0.25,
                        .input_min = -1,
                        .input_max = 1},
            asked);
  };
  navigate(2048, "0.03; p99 0.04");
  navigate(most, "0.12; 25 % of the peak");
  navigate_guided(2048, "0.15");
  learn(brief ? 1024 : 16384, "0.3");
  const MppiOptions swing{
      .horizon = 60, .samples = 2048, .temperature = 0.2, .variance = 4, .input_min = -5, .input_max = 5};
  compare("pendulum", Pendulum{}, {3.14159, 0}, 30, swing);
  if (brief) return;
  navigate_guided(most, "0.25");
  learn(most, "1; 25 % of the peak");
  SvgMppiOptions guided_swing = guided(60, 2048, 0.2, -5, 5);
  guided_swing.guides.gradient_variance = guided_swing.variance_min = 1, guided_swing.variance_max = 4;
  compare("pendulum", Pendulum{}, {3.14159, 0}, 30, guided_swing);
  compare("quadrotor", Quadrotor{}, {}, 60,
          MppiOptions{.horizon = 40,
                      .samples = 2048,
                      .temperature = 1,
                      .variance = {2, 8},
                      .input_min = {-6, -20},
                      .input_max = {6, 20}});
  for (int samples = 32; samples < most; samples *= 2) navigate(samples);  // the crossover
}

}  // namespace
}  // namespace slalom::bench

int main(int argc, char** argv) {
  slalom::bench::brief = argc > 1 && std::string_view(argv[1]) == "brief";
  try {
    slalom::bench::run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slalom_gpu_bench: %s\n", error.what());
    return 1;
  }
  return slalom::bench::failed > 0;
}
