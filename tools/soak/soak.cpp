#include "tools/soak/soak.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <thread>

#include "slalom/evaluation/lap.hpp"
#include "tools/soak/child_process.hpp"
#include "tools/soak/sensor_faults.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int seeds = 4;  // different laps, of which each is driven again and again
constexpr int laps_of_evaluation = 4;
constexpr double fault_drive = 20;  // s, simulated

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Bytes resident.
long memory() {
  std::ifstream in("/proc/self/statm");
  long total = 0, resident = 0;
  in >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}
int descriptors() {
  return static_cast<int>(std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}

/// The figures of a lap that do not depend on the clock, as text.
std::string figures(const evaluation::LapResult& lap) {
  char text[256];
  std::snprintf(text, sizeof text, "%d steps, %a s, cost %a, mean speed %a m/s, %d collisions", lap.steps,
                lap.time, lap.mean_sequence_cost, lap.mean_speed, lap.collisions);
  return text;
}

class Soak {
 public:
  Soak(const SoakArguments& arguments, const fs::path& folder, const std::atomic<bool>& interrupted)
      : arguments_(arguments),
        scenario_(load_scenario(arguments.scenario, arguments.method)),
        setup_{scenario_.environment, {scenario_.configuration, arguments.method}, scenario_.lap},
        folder_(folder),
        interrupted_(interrupted),
        random_(arguments.seed) {}

  SoakResult run(std::FILE* words) {
    const auto begin = Clock::now();
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    for (int round = 1; round == 1 || elapsed() < 3600 * arguments_.hours; ++round) {
      lap();
      faults();
      stall();
      kill();
      result_.memory_last = memory();
      result_.descriptors_last = descriptors();
      // The first rounds drive each seed for the first time.
      if (round <= seeds)
        result_.memory_first = result_.memory_last, result_.descriptors_first = result_.descriptors_last;
      result_.seconds = elapsed();
      if (interrupted_) break;
      say(words, round);
    }
    result_.interrupted = interrupted_;
    return result_;
  }

 private:
  std::uint64_t next_seed() { return arguments_.seed + static_cast<std::uint64_t>(count_++ % seeds); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  static void pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

  /// A lap in this process, in which one step in a hundred waits.
  void lap() {
    const std::uint64_t seed = next_seed();
    const auto wait = [&](const evaluation::ControlStep&) {
      if (uniform(0, 1) < 0.01) pause(uniform(0, 0.01));
    };
    const evaluation::LapResult driven = run_lap(setup_, seed, wait, &interrupted_);
    if (driven.cancelled) return;
    ++result_.laps.runs;
    for (const float ms : driven.tick_ms) {
      ++result_.ticks;
      result_.late_ticks += 1e-3 * static_cast<double>(ms) > setup_.control_period();
      result_.longest_tick = std::max(result_.longest_tick, 1e-3 * static_cast<double>(ms));
    }
    const auto [known, first] = figures_.try_emplace(seed, figures(driven));
    if (!first && known->second != figures(driven))
      result_.laps.failures.push_back("seed " + std::to_string(seed) + ": " + figures(driven) +
                                      "; before: " + known->second);
  }

  void faults() {
    if (interrupted_) return;
    const std::uint64_t seed = random_();
    const FaultRecord record =
        drive_with_sensor_faults(scenario_, arguments_.method, seed, fault_drive, interrupted_);
    ++result_.faults.runs;
    result_.spoilt += record.faults;
    result_.slowest_return = std::max(result_.slowest_return, record.slowest_return);
    if (!record.broken.empty())
      result_.faults.failures.push_back("seed " + std::to_string(seed) + ": " + record.broken);
  }

  /// A drive that is stopped for a while again and again: to it the clock jumps.
  void stall() {
    const std::uint64_t seed = next_seed();
    const fs::path whole = folder_ / ("whole-" + std::to_string(seed) + ".jsonl"),
                   stalled = folder_ / "stalled.jsonl";
    if (!fs::exists(whole) && drive(seed, whole).wait() != 0)
      return fail(result_.stalls, "a lap without stalls did not finish");
    ChildProcess& child = drive(seed, stalled);
    while (!child.ended() && !interrupted_) {
      pause(uniform(0, 0.2));
      child.send(SIGSTOP);
      pause(uniform(0, 0.3));
      child.send(SIGCONT);
    }
    if (interrupted_) return;
    ++result_.stalls.runs;
    if (child.wait() != 0)
      fail(result_.stalls, "status " + std::to_string(child.wait()));
    else if (content(stalled) != content(whole))
      fail(result_.stalls, "seed " + std::to_string(seed) + ": another recording");
  }

  /// An evaluation that is killed again and again, each time later, until it has finished.
  void kill() {
    const fs::path out = folder_ / "killed";
    fs::remove_all(out);
    double latest = 1;  // s
    for (bool finished = false; !finished; latest *= 1.5) {
      ChildProcess child(evaluation(out), printed());
      const auto end = Clock::now() + std::chrono::duration<double>(uniform(0, latest));
      while (!child.ended() && Clock::now() < end && !interrupted_) pause(0.005);
      if (interrupted_) return;
      child.send(SIGKILL);
      finished = child.wait() == 0;
      result_.kills.runs += !finished;
    }
    if (ChildProcess({"eval", "--check", out.string(), "--again", "1"}, printed()).wait() != 0)
      fail(result_.kills, "slalom eval --check: " + content(printed()));
  }

  ChildProcess& drive(std::uint64_t seed, const fs::path& recording) {
    auto words = scenario_words("drive");
    words.insert(words.end(), {"--method", arguments_.method, "--seed", std::to_string(seed), "--record",
                               recording.string()});
    child_ = std::make_unique<ChildProcess>(words, printed());
    return *child_;
  }
  std::vector<std::string> evaluation(const fs::path& out) const {
    auto words = scenario_words("eval");
    words.insert(words.end(),
                 {"--methods", arguments_.method, "--laps", std::to_string(laps_of_evaluation), "--seed0",
                  std::to_string(arguments_.seed), "--out", out.string(), "--resume"});
    return words;
  }
  std::vector<std::string> scenario_words(const std::string& command) const {
    const ScenarioArguments& a = arguments_.scenario;
    std::vector<std::string> words = {command,  "--course",    scenario_.folder.string(),  "--config",
                                      a.config, "--obstacles", std::to_string(a.obstacles)};
    for (const std::string& setting : a.set) words.insert(words.end(), {"--set", setting});
    return words;
  }
  fs::path printed() const { return folder_ / "printed.txt"; }
  void fail(TrialResult& trial, const std::string& sentence) const { trial.failures.push_back(sentence); }

  void say(std::FILE* words, int round) const {
    std::size_t failures = 0;
    for (const TrialResult* trial : {&result_.laps, &result_.faults, &result_.stalls, &result_.kills})
      failures += trial->failures.size();
    std::fprintf(
        words,
        "round %d, %.0f of %.0f s: %d laps, %d sensor faults, %d stalls, %d kills; %zu failures; %.1f MiB\n",
        round, result_.seconds, 3600 * arguments_.hours, result_.laps.runs, result_.spoilt,
        result_.stalls.runs, result_.kills.runs, failures,
        static_cast<double>(result_.memory_last) / (1 << 20));
    std::fflush(words);
  }

  SoakArguments arguments_;
  Scenario scenario_;
  evaluation::LapSetup setup_;
  fs::path folder_;
  const std::atomic<bool>& interrupted_;
  std::mt19937_64 random_;
  std::unique_ptr<ChildProcess> child_;
  std::map<std::uint64_t, std::string> figures_;
  int count_ = 0;  ///< laps so far
  SoakResult result_;
};

}  // namespace

bool SoakResult::passed() const {
  constexpr long min_growth = 16 << 20;  // bytes
  const bool grown = memory_last > memory_first + std::max(memory_first / 10, min_growth);
  return laps.failures.empty() && faults.failures.empty() && stalls.failures.empty() &&
         kills.failures.empty() && !grown && descriptors_last <= descriptors_first && !interrupted;
}

SoakResult soak(const SoakArguments& arguments, const fs::path& folder, std::FILE* words,
                const std::atomic<bool>& interrupted) {
  return Soak(arguments, folder, interrupted).run(words);
}

}  // namespace slalom::tools
