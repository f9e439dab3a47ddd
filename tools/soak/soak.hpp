#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/scenario/scenario.hpp"

namespace slalom::tools {

/// The scenario to drive, and for how long.
struct SoakArguments {
  ScenarioArguments scenario;  ///< scenario, whose course, config, set and obstacles count
  std::string method = "svg_mppi";
  std::uint64_t seed = 0;
  double hours = 1;
};

/// The outcome of one kind of trial.
struct TrialResult {
  std::string name{};
  int runs = 0;
  std::vector<std::string> failures{};  ///< one sentence each
};

/// The outcome of a soak. It has passed if no trial failed, memory did not grow by more than a tenth and 16
/// MiB, and no descriptor was lost.
struct SoakResult {
  TrialResult laps{"laps"};             ///< driven again in this process: the same bits
  TrialResult faults{"sensor faults"};  ///< see drive_with_sensor_faults
  TrialResult stalls{"stalls"};  ///< a process that is stopped at random: the same recording, byte for byte
  TrialResult kills{"kills"};    ///< evaluations killed at random and resumed: `slalom eval --check` passes
  int spoilt = 0;                ///< periods with a sensor fault
  double slowest_return = 0;     ///< s, see FaultRecord
  long ticks = 0,
       late_ticks = 0;      ///< control steps of the laps, and those that took longer than the control period
  double longest_tick = 0;  ///< s
  long memory_first = 0, memory_last = 0;           ///< bytes resident, after one round and at the end
  int descriptors_first = 0, descriptors_last = 0;  ///< open, likewise
  double seconds = 0;                               ///< seconds of wall clock
  bool interrupted = false;

  bool passed() const;
};

/// Runs the trials in turn, each at least once, until the time is over. Files are in `folder`, which exists.
/// Prints a line for each round to `words`. Throws as load_scenario does, and std::system_error if a process
/// cannot be started.
SoakResult soak(const SoakArguments& arguments, const std::filesystem::path& folder, std::FILE* words,
                const std::atomic<bool>& interrupted);

}  // namespace slalom::tools
