#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

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
  Particles(const LocaliserOptions& options, std::shared_ptr<const FreeCells> free_cells)
      : options_(options),
        free_cells_(std::move(free_cells)),
        now_(1, 3, options.max_particles),
        next_(1, 3, options.max_particles),
        noise_(1, 3, options.max_particles),
        log_fit_(padded(options.max_particles)),
        weights_(options.max_particles),
        cumulative_(weights_.size()),
        guide_(weights_.size()),
        bins_(options.max_particles, bin_size, bin_angle),
        places_(options.max_particles, place_size, place_angle) {}

  void spread_about(const maps::Pose& pose, double deviation, double yaw_deviation, RandomKey key) noexcept {
    fill_normal(noise_, 0, noise_.stride(), key);
    for (int i = 0; i < options_.max_particles; ++i)
      put_pose(now_, i,
               {pose.x + deviation * noise_.at(0, 0, i), pose.y + deviation * noise_.at(0, 1, i),
                maps::wrap_angle(pose.yaw + yaw_deviation * noise_.at(0, 2, i))});
    make_uniform(options_.max_particles);
  }

  void spread_everywhere(RandomKey key) noexcept {
    RandomStream random(key);
    for (int i = 0; i < options_.max_particles; ++i) put_pose(now_, i, free_cells_->random_pose(random));
    make_uniform(options_.max_particles);
  }

  void move(const Displacement& moved, RandomKey key) noexcept {
    fill_normal(noise_, 0, padded(count_), key);
    const float along = static_cast<float>(moved.step.x), across = static_cast<float>(moved.step.y);
    const float turn = static_cast<float>(moved.step.yaw);
    const float along_deviation = static_cast<float>(moved.along);
    const float across_deviation = static_cast<float>(moved.across);
    const float turn_deviation = static_cast<float>(moved.turn);
    float *x = now_.row(0, 0), *y = now_.row(0, 1), *yaw = now_.row(0, 2);
    const float *a = noise_.row(0, 0), *b = noise_.row(0, 1), *c = noise_.row(0, 2);
    for (int i = 0; i < count_; ++i) {
      const float dx = along + along_deviation * a[i], dy = across + across_deviation * b[i];
      const float cosine = std::cos(yaw[i]), sine = std::sin(yaw[i]);
      x[i] += cosine * dx - sine * dy;
      y[i] += sine * dx + cosine * dy;
      yaw[i] = slalom::wrap_angle(yaw[i] + turn + turn_deviation * c[i]);
    }
  }

  /// Multiplies the weights by the fits to the power of `exponent`. Returns the effective sample size.
  double weigh(const SensorTables& sensor, const ScanBeams& beams, double exponent) noexcept {
    float* log_fit = log_fit_.data();
    sensor.weigh(poses_of(now_, padded(count_)), beams, log_fit);
    const float best = *std::max_element(log_fit, log_fit + count_);
    const int used = sensor.model() == SensorModel::beam ? beams.count : beams.hits;
    const float power = static_cast<float>(exponent * used);
    double sum = 0;
    for (int i = 0; i < count_; ++i) {
      double& weight = weights_[i];
      weight *= static_cast<double>(std::exp(power * (log_fit[i] - best)));
      sum += weight;
    }
    // The best particle's own weight may have been tiny before.
    if (!(sum > 1e-290)) {
      make_uniform(count_);
      return count_;
    }
    double squares = 0;
    for (int i = 0; i < count_; ++i) {
      double& weight = weights_[i];
      weight /= sum;
      squares += weight * weight;
    }
    return 1 / squares;
  }

  /// Draws particles by weight; their number depends on the spread.
  void resample(RandomKey key) noexcept {
    accumulate_weights();
    const double shift = RandomStream(key).uniform();
    bins_.clear();
    int drawn = 0;
    double wanted = options_.min_particles;
    while (drawn < wanted && drawn < options_.max_particles) {
      double uniform = radical_inverse(static_cast<std::uint32_t>(drawn)) + shift;
      uniform -= uniform >= 1;
      const maps::Pose chosen = pose(draw(uniform));
      put_pose(next_, drawn++, chosen);
      if (bins_.add(chosen.x, chosen.y, chosen.yaw, 1))
        wanted = std::max<double>(options_.min_particles,
                                  kld_sample_size(bins_.occupied(), kld_error, kld_quantile));
    }
    std::swap(now_, next_);
    make_uniform(drawn);
  }

  struct Estimate {
    maps::Pose pose;
    double covariance[3][3] = {};
    double share = 0;  ///< share of the weight near the pose
  };

  /// Returns mean and spread of the particles about the heaviest bin.
  Estimate estimate() noexcept {
    places_.clear();
    for (int i = 0; i < count_; ++i) places_.add(x(i), y(i), yaw(i), weight(i));
    maps::Pose middle;
    for (int i = 0; i < count_; ++i) {
      if (!places_.in_heaviest(x(i), y(i), yaw(i))) continue;
      middle = pose(i);
      break;
    }
    Estimate found;
    // The window about any particle of the bin is moved onto the mean of what lies in it, twice.
    for (int pass = 0; pass < 3; ++pass) {
      double sum = 0, m[3] = {}, second[3][3] = {};
      for (int i = 0; i < count_; ++i) {
        const double d[3] = {x(i) - middle.x, y(i) - middle.y, maps::wrap_angle(yaw(i) - middle.yaw)};
        if (d[0] * d[0] + d[1] * d[1] > near_distance * near_distance || std::abs(d[2]) > near_angle)
          continue;
        const double w = weight(i);
        sum += w;
        for (int a = 0; a < 3; ++a) {
          m[a] += w * d[a];
          for (int b = 0; b < 3; ++b) second[a][b] += w * d[a] * d[b];
        }
      }
      if (!(sum > 0)) break;
      for (double& mean : m) mean /= sum;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) found.covariance[a][b] = second[a][b] / sum - m[a] * m[b];
      middle = {middle.x + m[0], middle.y + m[1], maps::wrap_angle(middle.yaw + m[2])};
      found.share = std::min(1.0, sum);
    }
    found.pose = middle;
    return found;
  }

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

  /// The binary digits of i after the point, an evenly spread sequence in [0, 1) (van der Corput 1935).
  static double radical_inverse(std::uint32_t i) {
    i = (i << 16) | (i >> 16);
    i = ((i & 0x00ff00ffu) << 8) | ((i >> 8) & 0x00ff00ffu);
    i = ((i & 0x0f0f0f0fu) << 4) | ((i >> 4) & 0x0f0f0f0fu);
    i = ((i & 0x33333333u) << 2) | ((i >> 2) & 0x33333333u);
    i = ((i & 0x55555555u) << 1) | ((i >> 1) & 0x55555555u);
    return i * 0x1p-32;
  }

  double x(int i) const noexcept { return now_.row(0, 0)[i]; }
  double y(int i) const noexcept { return now_.row(0, 1)[i]; }
  double yaw(int i) const noexcept { return now_.row(0, 2)[i]; }

  void make_uniform(int count) noexcept {
    count_ = count;
    std::fill_n(weights_.begin(), count, 1.0 / count);
  }

  void accumulate_weights() noexcept {
    double sum = 0;
    int part = 0;
    for (int i = 0; i < count_; ++i) {
      sum += weights_[i];
      cumulative_[i] = sum;
      for (; part < count_ && part < sum * count_; ++part) guide_[part] = i;
    }
    for (; part < count_; ++part) guide_[part] = count_ - 1;
  }

  int draw(double uniform) const noexcept {
    int i = guide_[saturate_cast<std::size_t>(uniform * count_)];
    while (i + 1 < count_ && cumulative_[i] <= uniform) ++i;
    return i;
  }

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
