// The worst latency of a solve: 100,000 solves of `svg_mppi` on the reference workload with a deadline of 2
// ms, one every millisecond, while another process keeps another core busy. Exits with status 1 if a solve
// took longer than 5 ms. Between solves it polls the clock for the same time, which shows how often the
// machine itself stops (a virtual machine is descheduled now and then).
//   slalom_latency_bench [solves] [threads] [milliseconds between two]
// Run it with real-time priority (chrt -f 50 slalom_latency_bench), as a controller would. Otherwise it
// measures how the system shares the core among all processes.

#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "bench/workload/statistics.hpp"
#include "slalom/core/instruction_set.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"

namespace slalom::workload {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double deadline = 2e-3, latest = 5e-3;  // s

void run_on(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  sched_setaffinity(0, sizeof set, &set);
}

/// A process that keeps a core busy, at ordinary priority.
pid_t start_hog(int core) {
  const pid_t child = fork();
  if (child != 0) return child;
  const sched_param ordinary{};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);
  run_on(core);
  for (volatile unsigned spins = 0;;) spins = spins + 1;
}

SvgMppiOptions reference_options(int threads) {
  SvgMppiOptions o;
  o.horizon = ReferenceWorkload::steps;
  o.samples = 8000;
  o.threads = threads;
  o.temperature = 3;
  o.variance = 0.1;
  o.input_min = -0.45;
  o.input_max = 0.45;
  return o;
}

struct Run {
  std::vector<double> times;  // ms
  long cut_short = 0, late = 0;
  long gaps = 0;       // longer than `latest`, while polling the clock
  double max_gap = 0;  // s
};

/// Polls the clock for as long as a solve took. A gap means that the machine stopped.
void watch_clock(double duration, Run& run) {
  const auto begin = Clock::now();
  for (auto last = begin;;) {
    const auto now = Clock::now();
    const double gap = std::chrono::duration<double>(now - last).count();
    run.max_gap = std::max(run.max_gap, gap);
    run.gaps += gap > latest;
    if (std::chrono::duration<double>(now - begin).count() >= duration) return;
    last = now;
  }
}

Run solve_often(long solves, int threads, double period) {
  const ReferenceWorkload workload;
  const auto model = workload.model(reference_problem(false), simd::active_target());
  const BatchEvaluator* const evaluator = &model->evaluator();
  const auto solver = make_solver(reference_options(threads), 1);
  Run run;
  run.times.reserve(static_cast<std::size_t>(solves));
  auto next = Clock::now();
  for (long i = 0; i < solves; ++i) {
    next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period));
    std::this_thread::sleep_until(next);
    const auto begin = Clock::now();
    const SolveResult& result = solver->solve(*evaluator, {.elapsed = period, .deadline = deadline});
    const double taken = std::chrono::duration<double>(Clock::now() - begin).count();
    run.times.push_back(1e3 * taken);
    run.cut_short += result.status == Status::deadline;
    run.late += taken > latest;
    watch_clock(taken, run);
    if (next < begin) next = begin;  // late: does not catch up with two at once
  }
  return run;
}

/// Counts in bins of doubling width.
void print_histogram(const std::vector<double>& times) {
  double low = 0;
  for (double high = 0.125; low < times.back(); high *= 2) {
    const auto in_bin =
        std::count_if(times.begin(), times.end(), [&](double t) { return t >= low && t < high; });
    if (in_bin > 0) std::printf("  %7.3f ... %8.3f ms %9ld\n", low, high, static_cast<long>(in_bin));
    low = high;
  }
}

int run(long solves, int threads, double period) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  const pid_t hog = start_hog(0);
  if (threads == 1) run_on(cores - 1);
  Run made = solve_often(solves, threads, period);
  kill(hog, SIGKILL);
  waitpid(hog, nullptr, 0);
  std::sort(made.times.begin(), made.times.end());
  const TimeStatistics t = time_statistics(made.times);
  std::printf("%s, %d thread%s, beside a busy core %d of %d: %ld solves\n", simd::name(simd::active_target()),
              threads, threads == 1 ? "" : "s", 0, cores, solves);
  std::printf(
      "p50 %.3f, p99 %.3f, p99.9 %.3f, max %.3f ms; %ld stopped at the deadline of %.0f ms, %ld later than "
      "%.0f ms\n",
      t.p50, t.p99, t.p999, t.max, made.cut_short, 1e3 * deadline, made.late, 1e3 * latest);
  std::printf("in the same time spent polling the clock: %ld gaps longer than that, the longest %.3f ms\n",
              made.gaps, 1e3 * made.max_gap);
  print_histogram(made.times);
  return made.late > 0;
}

}  // namespace
}  // namespace slalom::workload

int main(int count, char** arguments) {
  const long solves = count > 1 ? std::strtol(arguments[1], nullptr, 10) : 100000;
  const int threads = count > 2 ? static_cast<int>(std::strtol(arguments[2], nullptr, 10)) : 1;
  const double period = count > 3 ? 1e-3 * std::strtod(arguments[3], nullptr) : 1e-3;
  return slalom::workload::run(std::max(solves, 1L), std::max(threads, 1), period);
}
