#pragma once

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

  /// Whether the sensor model of the options also prefers `other` to `place`. That of beams does not count a
  /// reading that ends before a wall, at a car that is not in the map, as much as one that passes through it.
  bool confirms(const maps::Pose& other, const maps::Pose& place, const SensorTables& sensor,
                const ScanBeams& beams) noexcept;

 private:
  static constexpr int max_hypotheses = 96;
  static constexpr int search_factor = 28;  ///< random poses per hypothesis in each update
  static constexpr int copies = 12;         ///< copies of a hypothesis, itself included
  static constexpr int young = 6;           ///< updates: not yet to be compared with others
  static constexpr int newcomers = 8;       ///< in an update
  static constexpr double young_jitter = 0.2, young_yaw_jitter = 0.1;    ///< m, rad
  static constexpr double grown_jitter = 0.08, grown_yaw_jitter = 0.04;  ///< m, rad

  /// The hypotheses and disturbed copies of them at the front of the batch.
  void place_copies(RandomKey key) noexcept;

  void place_random(RandomKey key) noexcept;

  void take_best_copies(double memory) noexcept;

  /// Drops the worse of two hypotheses about the same place.
  void drop_twins() noexcept;

  /// Makes the best poses from `first` on hypotheses, in the place of the worst grown-up ones.
  void admit(int first) noexcept;

  maps::Pose batch_pose(int i) const noexcept {
    return {poses_.at(0, 0, i), poses_.at(0, 1, i), poses_.at(0, 2, i)};
  }

  void put(int i, const maps::Pose& pose) noexcept { put_pose(poses_, i, pose); }

  std::shared_ptr<const FreeCells> free_cells_;
  SequenceBatch poses_, noise_;  ///< [1][x, y, yaw][pose]
  AlignedBuffer log_fit_;
  std::vector<Hypothesis> hypotheses_;
  std::vector<int> newcomers_;
  int count_ = 0;  ///< number of hypotheses
};

}  // namespace slalom::vehicle::detail
