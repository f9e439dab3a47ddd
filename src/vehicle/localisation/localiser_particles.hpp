#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "localiser_bins.hpp"
#include "localiser_sensor.hpp"
#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

namespace slalom::vehicle::detail {

/// The free cells of a map, to draw poses from.
class FreeCells {
 public:
  /// `map` has been checked and has a free cell.
  explicit FreeCells(const maps::OccupancyGrid& map);
  /// Uniform over the free space and all yaws; in the frame of the grid.
  maps::Pose random_pose(RandomStream& random) const noexcept;

 private:
  std::vector<std::uint32_t> cells_;
  int width_;
  double resolution_;
};

/// The motion of the car between two updates, in its frame at the first one, and its uncertainty.
struct Motion {
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

  void move(const Motion& motion, RandomKey key) noexcept;

  /// Multiplies the weights by the particles' fits to the power of `exponent`; the effective sample size
  /// after that.
  double weigh(const SensorTables& sensor, const ScanBeams& beams, double exponent) noexcept;

  /// Draws particles by weight; their number depends on the spread.
  void resample(RandomKey key) noexcept;

  struct Estimate {
    maps::Pose pose;
    double covariance[3][3] = {};
    double share = 0;  ///< share of the weight near the pose
  };
  /// The mean and the spread of the particles about the heaviest bin.
  Estimate estimate() noexcept;

  int count() const noexcept { return count_; }
  maps::Pose pose(int i) const noexcept { return {x(i), y(i), yaw(i)}; }
  double weight(int i) const noexcept { return weights_[static_cast<std::size_t>(i)]; }

 private:
  double x(int i) const noexcept { return now_.row(0, 0)[i]; }
  double y(int i) const noexcept { return now_.row(0, 1)[i]; }
  double yaw(int i) const noexcept { return now_.row(0, 2)[i]; }
  void put(SequenceBatch& to, int i, const maps::Pose& pose) noexcept;
  void make_uniform(int count) noexcept;
  void accumulate_weights() noexcept;
  int draw(double uniform) const noexcept;

  LocaliserOptions options_;
  std::shared_ptr<const FreeCells> free_cells_;
  SequenceBatch now_, next_, noise_;  ///< [1][x, y, yaw][particle]
  AlignedBuffer log_fit_;
  std::vector<double> weights_, cumulative_;
  std::vector<int>
      guide_;  ///< for each of `count` equal parts of [0, 1): the first particle that reaches into it
  PoseBins bins_, places_;
  int count_ = 0;
};

}  // namespace slalom::vehicle::detail
