#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "tools/scenario/scenario.hpp"

namespace slalom::tools {

/// The result of a drive with sensor faults.
struct FaultRecord {
  int faults = 0;             ///< periods with a fault
  double slowest_return = 0;  ///< s, from the end of a fault until the planner plans again
  std::string broken;         ///< the first rule that was broken, and by what; empty if none was
};

/// Drives the scenario for `seconds` (simulated) with a planner that gets a faulty input for 0.3 s in every 2
/// s: scans without a number, without beams, that stand still or lose half of their beams; poses and speeds
/// that are not numbers, jump or are absurd. The rules: every command is finite and within the limits of the
/// planner; while an input cannot be used the status says so and the command is not faster than the car; and
/// within 0.1 s after the fault the planner plans again. A collision breaks no rule. Ends early if `cancel`
/// becomes true. The same seed makes the same drive. Throws as load_scenario does.
FaultRecord drive_with_sensor_faults(const Scenario& scenario, const std::string& method, std::uint64_t seed,
                                     double seconds, const std::atomic<bool>& cancel);

}  // namespace slalom::tools
