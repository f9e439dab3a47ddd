#pragma once

#include <vector>

#include "localiser_particles.hpp"

namespace slalom::vehicle::detail {

/// Hypotheses of other places where the car may be. Each one is tracked separately, by the best of a few
/// disturbed copies, and they compete by their fit over some time: within one set of particles the first
/// place that fits well would soon displace all others (the reason for clusters in Milstein, Sanchez &
/// Williamson, "Robust global localization using clustered particle filtering", AAAI 2002). In every update
/// poses from all of the free space are weighted, and the best become hypotheses.
class Search {
 public:
  explicit Search(std::shared_ptr<const FreeCells> free_cells);

  struct Hypothesis {
    maps::Pose pose;     ///< grid's frame
    double log_fit = 0;  ///< mean over beams, averaged over time once it is mature
    int age = 0;         ///< updates
  };

  void clear() noexcept { count_ = 0; }

  /// Moves, weights and selects. `memory` in [0, 1) is the share of the averaged fit that is kept.
  void update(const maps::Pose& step, const SensorTables& sensor, const ScanBeams& beams, double memory,
              RandomKey key) noexcept;

  /// The best mature hypothesis; null if none is.
  const Hypothesis* best() const noexcept;

  /// The mean over beams of the log of the fit at one pose.
  double log_fit_at(const maps::Pose& pose, const SensorTables& sensor, const ScanBeams& beams) noexcept;

 private:
  void place_copies(RandomKey key) noexcept;
  void place_random(RandomKey key) noexcept;
  void take_best_copies(double memory) noexcept;
  void drop_twins() noexcept;
  void admit(int first) noexcept;
  maps::Pose batch_pose(int i) const noexcept;
  void put(int i, const maps::Pose& pose) noexcept;

  std::shared_ptr<const FreeCells> free_cells_;
  SequenceBatch poses_, noise_;  ///< [1][x, y, yaw][pose]
  AlignedBuffer log_fit_;
  std::vector<Hypothesis> hypotheses_;
  std::vector<int> newcomers_;
  int count_ = 0;  ///< number of hypotheses
};

}  // namespace slalom::vehicle::detail
