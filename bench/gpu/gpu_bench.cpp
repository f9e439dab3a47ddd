// slalom_gpu_bench [check] [time] [cpu] [sanitize]: compares solves on a GPU with the processor's, and
// measures both; a row of CSV each, times in ms.

#include <chrono>
#include <cstdio>
#include <set>

#include "bench/gpu/random_network.hpp"
#include "slalom/gpu/gpu.hpp"
#include "slalom/slalom.hpp"

namespace slalom::bench {
namespace {

using Clock = std::chrono::steady_clock;
using problems::Pendulum;
using problems::Quadrotor;

int failed = 0;  ///< how many checks have failed
constexpr int most = 131072;

template <class P>
using StateOf = typename P::template State<double>;

/// A problem with the options of a solver.
template <class P, class Options>
struct Case {
  const char* name;
  P problem;
  StateOf<P> start;
  double dt;     ///< s
  double flops;  ///< of a step, counted by hand
  Options options;
};

/// A GPU draws one batch of white noise, and its temperatures are fixed.
void for_gpu(SvgMppiOptions& o) {
  o.batches = 1;
  o.noise.exponent = 0;
  o.guides.gradient_temperature = 1;
  o.guides.count = 4, o.guides.iterations = 10, o.guides.gradient_samples = 25;
}
template <class Options = MppiOptions>
Case<Navigation, Options> navigation(int samples) {
  static const CostMap map;
  Options o{.horizon = 100,
            .samples = samples,
            .temperature = 1,
            .input_min = {-0.35, -0.5},
            .input_max = {0.5, 0.5}};
  if constexpr (std::is_same_v<Options, SvgMppiOptions>) {
    for_gpu(o);
    o.variance_min = 0.01, o.variance_max = 0.04;
    o.guides.gradient_variance = o.guides.variance = o.guides.restart_variance = 0.04, o.guides.step = 0.02;
  } else {
    o.variance = 0.04;
  }
  Navigation problem;
  problem.map = map.view();
  return {"navigation", problem, {7.4, 7.4, 0.785398}, 0.02, 45, o};
}
Case<Learned, MppiOptions> network(int samples) {
  MppiOptions o{
      .horizon = 50, .samples = samples, .temperature = 1, .variance = 0.25, .input_min = -1, .input_max = 1};
  return {"network", {random_network()}, {1, 0, 0}, 0, 2 * 1280 + 64 * 8, o};
}
Case<Pendulum, MppiOptions> pendulum(int samples) {
  MppiOptions o{.horizon = 60, .samples = samples, .variance = 4, .input_min = -5, .input_max = 5};
  o.temperature = 0.2;
  return {"pendulum", {}, {3.14159, 0}, 0.02, 30, o};
}
Case<Pendulum, SvgMppiOptions> guided_pendulum(int samples) {
  SvgMppiOptions o{.horizon = 60, .samples = samples, .temperature = 0.2, .input_min = -5, .input_max = 5};
  for_gpu(o);
  o.guides.gradient_variance = o.variance_min = 1, o.variance_max = 4;
  return {"pendulum", {}, {3.14159, 0}, 0.02, 30, o};
}
Case<Quadrotor, MppiOptions> quadrotor(int samples) {
  MppiOptions o{
      .horizon = 40, .samples = samples, .temperature = 1, .input_min = {-6, -20}, .input_max = {6, 20}};
  o.variance = {2, 8};
  return {"quadrotor", {}, {}, 0.05, 60, o};
}

template <class P>
StateOf<P> advanced(const P& p, const StateOf<P>& x, const SolveResult& plan) {
  Input<double, P::inputs> u;
  for (int i = 0; i < P::inputs; ++i) u[i] = static_cast<double>(plan.inputs[static_cast<std::size_t>(i)]);
  return slalom::detail::step<P, double>(p, x, slalom::detail::look_up<P, double>(p, x), u, 0);
}

/// Compares plans of a closed loop with the processor's of the same seed, and bits with those of another
/// number of blocks. The constructor has compared costs.
template <class P, class Options>
void check(const Case<P, Options>& c, int solves) {
  gpu::GpuController<P, Options> one(c.problem, c.options), other(c.problem, c.options);
  other.gpu_solver().set_blocks(37);
  ProblemEvaluator<P> evaluator(c.problem);
  const auto processor = make_solver(c.options, P::inputs);
  double first = 0, largest = 0;
  int bits = 0;
  auto x = c.start;
  for (int n = 0; n < solves; ++n) {
    evaluator.set_state(x);
    const SolveResult &expected = processor->solve(evaluator, {.elapsed = c.dt}),
                      &plan = one.gpu_solver().solve(evaluator, {.elapsed = c.dt}),
                      &same = other.gpu_solver().solve(evaluator, {.elapsed = c.dt});
    for (std::size_t r = 0; r < plan.inputs.size(); ++r) {
      largest = std::max<double>(largest, std::abs(plan.inputs[r] - expected.inputs[r]));
      bits += plan.inputs[r] != same.inputs[r];
    }
    if (n == 0) first = largest;
    x = advanced(c.problem, x, expected);
  }
  const bool good = bits == 0 && first < 1e-3 && one.fault().empty();
  failed += !good;
  std::printf(
      "check,%s,%s,%d,first plan %.1e, of %d solves %.1e from the processor's; %d bits by blocks%s%s\n",
      c.name, Options::method, c.options.samples, first, solves, largest, bits, good ? "" : ": FAILED ",
      one.fault().c_str());
}

/// Times `solve` in a closed loop, from the state to the plan, and prints median and 99th percentile.
template <class P, class Options>
void time_loop(const char* where, const Case<P, Options>& c, double limit, ProblemEvaluator<P>& evaluator,
               Solver& solver, const char* more) {
  std::vector<double> times;
  auto x = c.start;
  const auto end = Clock::now() + std::chrono::duration<double>(limit);
  for (int n = 0; n < 1000 && (n < 8 || Clock::now() < end); ++n) {
    if (n % 400 == 0) x = c.start;
    evaluator.set_state(x);
    const auto begin = Clock::now();
    evaluator.set_state(x);
    const SolveResult& result = solver.solve(evaluator, {.elapsed = c.dt});
    if (n > 2) times.push_back(1e3 * std::chrono::duration<double>(Clock::now() - begin).count());
    x = advanced(c.problem, x, result);
  }
  std::sort(times.begin(), times.end());
  std::printf("%s,%s,%s,%d,%.4f,%.4f,%s\n", where, c.name, Options::method, c.options.samples,
              times[times.size() / 2], times[times.size() * 99 / 100], more);
  std::fflush(stdout);
}

/// Times of the GPU, with those of launches alone; `asked` is printed beside them.
template <class P, class Options>
void time_gpu(const Case<P, Options>& c, const char* asked = "") {
  gpu::GpuController<P, Options> controller(c.problem, c.options);
  auto& solver = controller.gpu_solver();
  constexpr int queued = 100;
  for (int n = 0; n < queued; ++n) solver.solve(controller.evaluator(), {.elapsed = c.dt});
  const auto begin = Clock::now();
  for (int n = 0; n < queued; ++n) solver.enqueue(controller.evaluator(), 0);
  solver.synchronize();
  const double device = 1e3 * std::chrono::duration<double>(Clock::now() - begin).count() / queued;
  char more[200];
  std::snprintf(more, sizeof more, "device %.4f,%.2f TFLOP/s,%s%s", device,
                c.flops * c.options.samples * c.options.horizon / device * 1e-9, asked,
                controller.fault().c_str());
  time_loop("gpu", c, 10, controller.evaluator(), solver, more);
}

template <class P, class Options>
void time_processor(Case<P, Options> c) {
  for (const int threads : {1, 16}) {
    c.options.threads = threads;
    ProblemEvaluator<P> evaluator(c.problem);
    time_loop(threads == 1 ? "cpu1" : "cpu16", c, 0.4, evaluator, *make_solver(c.options, P::inputs), "");
  }
}

void checks() {
  check(pendulum(2048), 20);
  check(guided_pendulum(2048), 20);
  check(quadrotor(2048), 5);
  check(navigation(2048), 5);
  check(navigation(most), 2);
  check(navigation<SvgMppiOptions>(2048), 3);
  check(network(1024), 3);
  check(network(16384), 3);
  check(network(most), 1);
}

void times() {
  for (int samples = 32; samples < most; samples *= 2)
    time_gpu(navigation(samples), samples == 2048 ? "asked 0.03; p99 0.04" : "");
  time_gpu(navigation(most), "asked 0.12");
  time_gpu(navigation<SvgMppiOptions>(2048), "asked 0.15");
  time_gpu(navigation<SvgMppiOptions>(most), "asked 0.25");
  time_gpu(network(1024));
  time_gpu(network(16384), "asked 0.3");
  time_gpu(network(most), "asked 1; 16.75 TFLOP/s");
  for (const int samples : {2048, most}) time_gpu(pendulum(samples)), time_gpu(quadrotor(samples));
  time_gpu(guided_pendulum(2048));
}

void processor() {
  for (const int samples : {32, 64, 128, 256, 512, 1024, 2048, 16384, most})
    time_processor(navigation(samples));
  time_processor(navigation<SvgMppiOptions>(2048));
  time_processor(pendulum(2048));
  time_processor(quadrotor(2048));
  time_processor(network(16384));
}

/// Short solves for compute-sanitizer.
void sanitized() {
  check(guided_pendulum(512), 2);
  check(navigation(2048), 1);
  auto fused = navigation(32768);
  fused.options.horizon = 10;
  check(fused, 1);
  check(network(1024), 1);
}

}  // namespace
}  // namespace slalom::bench

int main(int argc, char** argv) {
  using namespace slalom::bench;
  const std::set<std::string> parts(argv + 1, argv + argc);
  try {
    if (parts.contains("check")) checks();
    if (parts.contains("sanitize")) sanitized();
    if (parts.contains("cpu")) processor();
    if (parts.contains("time")) times();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slalom_gpu_bench: %s\n", error.what());
    return 1;
  }
  return failed > 0;
}
