#pragma once

#include <string>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "bench/workload/statistics.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

/// What `slalom bench` measures. All times of one core unless threads are said; every measurement goes on for
/// `seconds` of wall clock or 30 repetitions, whichever is longer.
namespace slalom::tools {

struct RolloutSpeed {
  TimeStatistics yardstick;  ///< ns a step
  TimeStatistics rollout;    ///< ns a step
};
/// Rollouts and the yardstick by turns, so that both meet the same clock.
RolloutSpeed measure_rollouts(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem,
                              int samples, int steps, simd::Target target, double seconds);

struct SolveSpeed {
  std::string method;
  TimeStatistics solve;      ///< ms
  TimeStatistics prepared;   ///< ms, with the noise drawn before the solve
  TimeStatistics yardstick;  ///< ns a step, in between
  StageTimes stages;         ///< s, medians
  double degenerate_share;   ///< of the solves: the published sv_mpc drives its particles apart
};
SolveSpeed measure_solve(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem,
                         const SolverOptions& options, double seconds);

struct TickSpeed {
  TimeStatistics tick;          ///< ms, a whole update of the planner
  TimeStatistics round_solver;  ///< ms, of it without the solve
};
/// The planner with svg_mppi, driven along the course from scan to scan.
TickSpeed measure_tick(const vehicle::Configuration& configuration, double seconds);

/// Additions and multiplications of one step and its cost in the published problem with one trajectory;
/// counted by hand from the formulas (28 + 21 sines and cosines, 27 motion, 12 look-up, 15 cost).
inline constexpr double operations_per_step = 103;

}  // namespace slalom::tools
