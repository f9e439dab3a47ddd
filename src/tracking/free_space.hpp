#pragma once

#include "slalom/core/reserved_vector.hpp"
#include "tracking/readings.hpp"

namespace slalom::tracking {

/// Finds motion between scans, without a map. Some earlier scans are kept. A reading has entered free space
/// if an earlier scan saw through its place; an earlier one has left if the present scan does.
class FreeSpace {
 public:
  /// Keeps scans of at most `max_beams`.
  explicit FreeSpace(int max_beams);

  void clear() noexcept { kept_ = 0; }  ///< forgets all scans
  /// Keeps the present scan if the last one that was kept is old enough.
  void keep(const Readings& scan, double stamp) noexcept;
  /// Finds the earlier readings whose place the present scan sees through by `margin` (m), which grows with
  /// the way of the sensor since then, for the error of its odometry.
  void find_left(const Readings& scan, double stamp, double margin) noexcept;

  /// Whether a cluster moves: much of it has entered free space, or something has left the space around it
  /// and it is not where an earlier scan has readings. `reach` (m) is how far it can have come, and its size.
  bool moves(std::span<const Reading> cluster, double margin, double reach) const noexcept;

 private:
  struct Past {
    double stamp = 0;
    Readings scan;
  };
  static constexpr double spacing = 0.1;         ///< s between scans that are kept
  static constexpr int compared[2] = {1, 5};     ///< scans back from the last one that was kept
  static constexpr int scans = compared[1] + 1;  ///< scans that are kept
  const Past* past(int back) const noexcept;

  std::vector<Past> past_;
  int kept_ = 0, last_ = 0;
  maps::Pose here_;  ///< pose of the sensor in the present scan
  ReservedVector<maps::Point> left_;
};

}  // namespace slalom::tracking
