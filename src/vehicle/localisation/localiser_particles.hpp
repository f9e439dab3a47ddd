#pragma once

#include "localiser_bins.hpp"
#include "localiser_sensor.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

namespace slalom::vehicle::detail {

/// Writes a pose as a sample of a batch [1][x, y, yaw].
inline void put_pose(SequenceBatch& to, int i, const maps::Pose& pose) noexcept {
  to.at(0, 0, i) = static_cast<float>(pose.x);
  to.at(0, 1, i) = static_cast<float>(pose.y);
  to.at(0, 2, i) = static_cast<float>(pose.yaw);
}

/// The samples of such a batch as particles.
inline ParticlePoses poses_of(const SequenceBatch& batch, int count) noexcept {
  return {batch.row(0, 0), batch.row(0, 1), batch.row(0, 2), count};
}

/// The free cells of a map, to draw poses from.
class FreeCells {
 public:
  /// `map` has been checked and has a free cell.
  explicit FreeCells(const maps::OccupancyGrid& map) : width_(map.width), resolution_(map.resolution) {
    for (std::size_t i = 0; i < map.cells.size(); ++i)
      if (map.cells[i] == maps::Occupancy::free) cells_.push_back(static_cast<std::uint32_t>(i));
  }
  /// Uniform over the free space and all yaws; in the frame of the grid.
  maps::Pose random_pose(RandomStream& random) const noexcept {
    const std::size_t at = saturate_cast<std::size_t>(random.uniform() * static_cast<double>(cells_.size()));
    const int cell = static_cast<int>(cells_[at]);
    const int column = cell % width_, row = cell / width_;
    const double x = (column + random.uniform()) * resolution_;
    const double y = (row + random.uniform()) * resolution_;
    return {x, y, random.uniform(-std::numbers::pi, std::numbers::pi)};
  }

 private:
  std::vector<std::uint32_t> cells_;
  int width_;
  double resolution_;
};

/// The displacement of the car between two updates, in its frame at the first one, and its uncertainty.
struct Displacement {
  maps::Pose step;    ///< m, rad
  double along = 0;   ///< m, standard deviations
  double across = 0;  ///< m
  double turn = 0;    ///< rad
};

/// The particles of the filter, in the frame of the grid (metres from the corner of cell (0, 0)), and what is
/// done to them. Nothing allocates after construction.
class Particles {
 public:
  Particles(const LocaliserOptions& options, std::shared_ptr<const FreeCells> free_cells);

  void spread_about(const maps::Pose& pose, double deviation, double yaw_deviation, RandomKey key) noexcept;

  void spread_everywhere(RandomKey key) noexcept;

  void move(const Displacement& moved, RandomKey key) noexcept;

  /// Multiplies the weights by the fits to the power of `exponent`. Returns the effective sample size.
  double weigh(const SensorTables& sensor, const ScanBeams& beams, double exponent) noexcept;

  /// Draws particles by weight; their number depends on the spread.
  void resample(RandomKey key) noexcept;

  struct Estimate {
    maps::Pose pose;
    double covariance[3][3] = {};
    double share = 0;  ///< share of the weight near the pose
  };

  /// Returns mean and spread of the particles about the heaviest bin.
  Estimate estimate() noexcept;

  int count() const noexcept { return count_; }
  maps::Pose pose(int i) const noexcept { return {x(i), y(i), yaw(i)}; }
  double weight(int i) const noexcept { return weights_[i]; }

 private:
  static constexpr double kld_error = 0.05;      ///< epsilon, bound on the Kullback-Leibler divergence
  static constexpr double kld_quantile = 2.326;  ///< normal quantile: the bound holds in 99 % of updates
  static constexpr double bin_size = 0.25, bin_angle = 0.1745;  ///< m, rad, bins for the number of particles
  /// Bins among which the heaviest is looked for, and how far about it particles belong to it.
  static constexpr double place_size = 0.5, place_angle = 0.5;     ///< m, rad
  static constexpr double near_distance = 0.75, near_angle = 0.6;  ///< m, rad

  double x(int i) const noexcept { return now_.row(0, 0)[i]; }
  double y(int i) const noexcept { return now_.row(0, 1)[i]; }
  double yaw(int i) const noexcept { return now_.row(0, 2)[i]; }

  void make_uniform(int count) noexcept;

  void accumulate_weights() noexcept;

  int draw(double uniform) const noexcept;

  LocaliserOptions options_;
  std::shared_ptr<const FreeCells> free_cells_;
  SequenceBatch now_, next_, noise_;  ///< [1][x, y, yaw][particle]
  AlignedBuffer log_fit_;
  std::vector<double> weights_, cumulative_;
  std::vector<int> guide_;  ///< for each of `count` equal parts of [0, 1): the first particle that reaches it
  PoseBins bins_, places_;
  int count_ = 0;
};

}  // namespace slalom::vehicle::detail
