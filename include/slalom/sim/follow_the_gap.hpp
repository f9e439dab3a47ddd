#pragma once

#include <span>
#include <vector>

#include "slalom/maps/command.hpp"

namespace slalom::sim {

/// Drives by a scan alone: a bubble around the nearest return is blocked, and the car steers for the farthest
/// part of the last gap in the order of the beams. After Sezer & Gokasan, "A novel obstacle avoidance
/// algorithm: Follow the Gap Method", Robotics and Autonomous Systems 60(9), 2012, as f1tenth_benchmarks has
/// it: it takes a beam for 2 pi over the number of beams, and steers by half the angle.
class FollowTheGap {
 public:
  /// Returns the command for a scan, m; {0, 0} for one without a gap.
  Command command(std::span<const double> scan);

 private:
  std::vector<double> ranges_;
};

}  // namespace slalom::sim
