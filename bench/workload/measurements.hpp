#pragma once

#include "bench/workload/reference_workload.hpp"
#include "bench/workload/statistics.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

/// The measurements of `slalom bench`. All times are of one core unless the number of threads is given. Every
/// measurement takes `seconds` of wall-clock time or 30 repetitions, whichever is longer.
namespace slalom::workload {

/// Throws std::logic_error if rollouts of the reference problem and the yardstick differ in more than 0.2 %
/// of their costs. Rounding may move a state at the edge of a cell into the next one.
void compare_with_yardstick(const ReferenceWorkload& workload, simd::Target target);

struct RolloutSpeed {
  TimeStatistics yardstick;              ///< ns per step
  std::vector<TimeStatistics> rollouts;  ///< ns per step with its cost, in the order of the problems
};
/// Measures the yardstick and the rollouts of each problem alternately, so that all have one clock frequency.
RolloutSpeed measure_rollouts(const ReferenceWorkload& workload,
                              std::span<const vehicle::VehicleOptions> problems, int samples, int steps,
                              simd::Target target, double seconds);

struct SolveSpeed {
  std::string method;
  TimeStatistics solve;      ///< ms
  TimeStatistics prepared;   ///< ms, with the noise drawn before the solve
  TimeStatistics yardstick;  ///< ns per step, measured between solves
  StageTimes stages;         ///< s, medians
  double degenerate_share;   ///< fraction of the solves; the particles of sv_mpc as in the paper diverge
};
SolveSpeed measure_solve(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem,
                         const SolverOptions& options, double seconds);

/// The planner with svg_mppi on successive scans along the course, at 4 m/s. A planner with slipping tyres
/// estimates the motion of the car. So its poses are those of a steady drive, longer than the window of the
/// identification, and it starts anew where they do: otherwise it would see a car that makes no progress, and
/// reverse.
class DrivenPlanner {
 public:
  explicit DrivenPlanner(const vehicle::Configuration& configuration);
  /// Plans at the next pose.
  const vehicle::PlannerOutput& update();

 private:
  std::vector<maps::ReferencePoint> course_ = reference_course();
  std::vector<maps::Pose> poses_;
  std::vector<ReferenceScan> scans_;
  bool estimates_ = false;
  std::size_t at_ = 0;
  vehicle::Planner planner_;
};

struct TickSpeed {
  TimeStatistics tick;          ///< ms, a whole update of the planner
  TimeStatistics round_solver;  ///< ms, of the update without the solve
};
/// Measures DrivenPlanner.
TickSpeed measure_tick(const vehicle::Configuration& configuration, double seconds);

}  // namespace slalom::workload
