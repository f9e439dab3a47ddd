// Whether planner and navigator keep their periods on one core with real-time priority, while a process at
// ordinary priority keeps another core busy and takes, writes and frees memory.
//   slalom_realtime_bench [minutes]
// Status 1: an update ended after its period, allocated memory or had a page fault. An update that is late
// where a virtual machine stopped is counted apart: the host took the core away (/proc/stat), or a thread on
// the other core, which wakes every 0.5 ms, stood still, too. Status 77: no right to real-time priority.

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "bench/workload/measurements.hpp"
#include "slalom/navigation/navigator.hpp"
#include "support/allocations.hpp"

namespace slalom::workload {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds period(0.025);  // of the planner; the navigator has twice this

/// Whether the calling thread now runs on this core, with real-time priority unless `priority` is 0.
bool run_on(int core, int priority) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  const sched_param wanted{priority};
  return sched_setaffinity(0, sizeof set, &set) == 0 &&
         sched_setscheduler(0, priority > 0 ? SCHED_FIFO : SCHED_OTHER, &wanted) == 0;
}

/// A process on core 0 that writes 1 GiB of new memory over and over.
pid_t start_neighbour() {
  const pid_t child = fork();
  if (child != 0) return child;
  run_on(0, 0);
  for (constexpr std::size_t size = std::size_t{1} << 30;;) {
    void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) continue;
    for (std::size_t at = 0; at < size; at += 4096) static_cast<char*>(memory)[at] = 1;
    munmap(memory, size);
  }
}

std::atomic<double> longest_stop{0};  ///< s, of the clock of core 0 since it was last set to 0
std::atomic<bool> ends{false};

void watch_clock() {
  run_on(0, 60);
  for (auto last = Clock::now(); !ends;) {
    std::this_thread::sleep_for(std::chrono::microseconds(500));
    const auto now = Clock::now();
    longest_stop = std::max(longest_stop.load(), Seconds(now - last).count());
    last = now;
  }
}

/// The time that the host of a virtual machine has taken from this core so far, in hundredths of a second.
long stolen() {
  char text[1 << 14], core[16];
  std::snprintf(core, sizeof core, "\ncpu%d ", sched_getcpu());
  const int file = open("/proc/stat", O_RDONLY | O_CLOEXEC);
  const ssize_t size = read(file, text, sizeof text - 1);
  close(file);
  text[std::max<ssize_t>(size, 0)] = '\0';
  const char* const line = std::strstr(text, core);
  long taken = 0;
  if (line != nullptr) std::sscanf(line, " %*s %*d %*d %*d %*d %*d %*d %*d %ld", &taken);
  return taken;
}

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

/// The updates of one part.
struct Part {
  const char* name;
  Seconds period;
  std::vector<double> times{};  ///< ms
  long late = 0, stopped = 0, allocations = 0, faults = 0;

  /// `taken` is stolen() before the update was due.
  template <class Update>
  void measure(Clock::time_point due, long taken, Update&& update) {
    const long allocated = testing::allocations(), faulted = page_faults();
    const auto begin = Clock::now();
    update();
    const auto end = Clock::now();
    allocations += testing::allocations() - allocated;
    faults += page_faults() - faulted;
    times.push_back(1e3 * Seconds(end - begin).count());
    const Seconds lateness = end - due - period;
    if (lateness.count() <= 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // the other clock tells its stop after it
    const double stop = std::max(longest_stop.load(), 0.01 * static_cast<double>(stolen() - taken));
    ++(stop > 0.5 * std::min(lateness, period).count() ? stopped : late);
  }
};

int run(double minutes) {
  const pid_t neighbour = start_neighbour();
  DrivenPlanner planner(vehicle::load_configuration(SLALOM_CONFIGS "/default.yaml"));

  constexpr double step = 2 * period.count();
  maps::OccupancyGrid grid{240, 160, 0.05, {}, std::vector(240 * 160, maps::Occupancy::free)};
  for (int column = 115; column < 125; ++column) grid.at(column, 110) = maps::Occupancy::occupied;
  navigation::Costmap costmap(grid.width, grid.height, grid.resolution);
  navigation::Navigator navigator(navigation::Footprint::rectangle(0.35, 0.35, 0.5), {},
                                  navigation::svg_mppi_options({}), costmap);
  const maps::Pose path[] = {{1.5, 4.8, 0}, {10.5, 4.8, 0}};
  navigator.set_path(path);
  maps::Pose robot = path[0];

  Part parts[] = {{"planner", period}, {"navigator", 2 * period}};
  const long warm_up = 100, ticks = warm_up + std::lround(60 * minutes / period.count());
  for (Part& part : parts) part.times.reserve(static_cast<std::size_t>(ticks));
  std::thread watch(watch_clock);
  const bool real_time = mlockall(MCL_CURRENT | MCL_FUTURE) == 0 &&
                         run_on(static_cast<int>(std::thread::hardware_concurrency()) - 1, 50);
  auto due = Clock::now();
  for (long tick = 0; real_time && tick < ticks; ++tick) {
    if (tick == warm_up)
      for (Part& part : parts) part.times.clear(), part.late = part.stopped = part.faults = 0;
    due = std::max(due + std::chrono::duration_cast<Clock::duration>(period), Clock::now());
    longest_stop = 0;
    const long taken = stolen();
    std::this_thread::sleep_until(due);
    parts[0].measure(due, taken, [&] { planner.update(); });
    if (tick % 2 == 0)
      parts[1].measure(due, taken, [&] {
        costmap.update(grid);
        navigator.update(robot, {.forward = 0.4}, costmap, step);
        robot.x = robot.x < 9 ? robot.x + 0.4 * step : path[0].x;
      });
  }
  ends = true;
  watch.join();
  kill(neighbour, SIGKILL);
  waitpid(neighbour, nullptr, 0);
  if (!real_time) return std::puts("skipped: no right to real-time priority and locked memory"), 77;

  bool failed = false;
  for (const Part& p : parts) {
    const TimeStatistics t = time_statistics(p.times);
    std::printf(
        "%-9s %zu updates, p50 %.3f, max %.3f ms; later than %.0f ms: %ld, and %ld where the machine ",
        p.name, p.times.size(), t.p50, t.max, 1e3 * p.period.count(), p.late, p.stopped);
    std::printf("stopped; %ld allocations, %ld page faults\n", p.allocations, p.faults);
    failed |= p.late + p.allocations + p.faults > 0;
  }
  return failed;
}

}  // namespace
}  // namespace slalom::workload

int main(int count, char** arguments) {
  return slalom::workload::run(std::clamp(count > 1 ? std::strtod(arguments[1], nullptr) : 30, 0.01, 1e4));
}
