#pragma once

#include <span>
#include <vector>

#include "slalom/maps/command.hpp"

namespace slalom::sim {

/// Options of FollowTheGap. The defaults are those of the racing benchmark (f1tenth_benchmarks).
struct FollowTheGapOptions {
  int skipped = 135;           ///< beams at each end of the scan that are not used
  int smoothing = 3;           ///< beams, of the mean over neighbours
  double range_max = 10;       ///< m, longer ranges count as this
  int bubble = 160;            ///< beams to each side of the nearest return that count as blocked
  int min_gap = 5;             ///< beams; a gap must have more
  int target_width = 80;       ///< beams, of the mean whose maximum is steered for
  double steer_max = 0.4;      ///< rad
  double slow_above = 0.174;   ///< rad, of steering
  double speed = 5, slow = 3;  ///< m/s
};

/// Drives by a scan alone: a bubble around the nearest return is blocked, and the car steers for the farthest
/// part of the last gap in the order of the beams. After Sezer & Gokasan, "A novel obstacle avoidance
/// algorithm: Follow the Gap Method", Robotics and Autonomous Systems 60(9), 2012, as f1tenth_benchmarks has
/// it: it takes a beam for 2 pi over the number of beams, and steers by half the angle.
class FollowTheGap {
 public:
  /// With these options; they are not checked.
  explicit FollowTheGap(const FollowTheGapOptions& options = {}) : options_(options) {}

  /// The command for a scan, m; {0, 0} for one without a gap.
  Command command(std::span<const double> scan);

 private:
  FollowTheGapOptions options_;
  std::vector<double> ranges_;
};

}  // namespace slalom::sim
