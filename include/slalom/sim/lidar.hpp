#pragma once

#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/shapes.hpp"
#include "slalom/sim/track.hpp"

namespace slalom::sim {

namespace detail {
struct ScanKernels;
}

/// Options of a LiDAR scanner on a car.
struct LidarOptions {
  int beams = 1080;  ///< 1 to 100000
  double field_of_view =
      4.7;                ///< rad, from the first beam to the last, which lie evenly about the sensor's axis
  double range_max = 30;  ///< m; the range of a beam that meets nothing nearer
  double noise = 0.01;    ///< m, standard deviation of each range
  double rate = 0;        ///< Hz, rounded to whole time steps; 0 scans in every step
  maps::Pose mount{0.10355, 0, 0};  ///< pose of the sensor on the car, from the centre of gravity
  double dropout = 0;               ///< share of beams that come back without a return: range_max

  GymLidar gym{};  ///< reproduction of f1tenth_gym

  /// The Hokuyo UTM-30LX by its data sheet: 1081 beams over 270 degrees at 40 Hz, 30 m, 10 mm of noise (to 10
  /// m).
  static LidarOptions hokuyo_utm_30lx();

  double angle_increment() const { return beams > 1 ? field_of_view / (beams - 1) : 0; }  ///< rad
  double angle_min() const { return beams > 1 ? -field_of_view / 2 : 0; }                 ///< rad

  /// Throws std::invalid_argument naming the field, its value and the rule it breaks.
  void validate() const;
};

/// A planar laser scanner. By default a range is exact: to the outline of the first wall cell on the beam,
/// found by steps that the clearance of each cell allows (sphere tracing, J. C. Hart, 1996), for 16
/// neighbouring beams together as long as they are close to each other, and from cell to cell where it allows
/// none. In SIMD lanes over beams; every instruction set gives the same bits.
class Lidar {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit Lidar(const LidarOptions& options);

  /// The options given at construction.
  const LidarOptions& options() const noexcept { return options_; }
  std::span<const double> angles() const noexcept { return angles_; }  ///< rad, in the sensor's frame
  /// Ranges are written to arrays of this size: beams, then padding of no meaning.
  std::size_t padded_beams() const noexcept { return cosines_.size(); }

  /// The pose of the sensor of a car at `car`.
  maps::Pose sensor_pose(const maps::Pose& car) const noexcept;

  /// The distances (m) to the walls of the track from a sensor at `sensor`, without noise; padded_beams()
  /// values. From outside the map they are 0 with TrackOptions::outside_is_wall, else range_max.
  void scan(const Track& track, const maps::Pose& sensor, std::span<float> ranges) const noexcept;

  /// Shortens ranges to a body where it is nearer. Only beams that can hit it are looked at. padded_beams()
  /// values.
  void cast(const maps::Pose& sensor, const Box& box, std::span<float> ranges) const noexcept;
  /// Shortens ranges (m) to a disc where it is nearer.
  void cast(const maps::Pose& sensor, const Disc& disc, std::span<float> ranges) const noexcept;

  /// Like `scan`, with the ranges of f1tenth_gym (GymLidar::ranges) in float64; one value per beam.
  void gym_scan(const Track& track, const maps::Pose& sensor, std::span<double> ranges) const noexcept;
  /// Like `cast`, as in f1tenth_gym.
  void gym_cast(const maps::Pose& sensor, const Box& box, std::span<double> ranges) const noexcept;
  /// Like `cast`, as in f1tenth_gym.
  void gym_cast(const maps::Pose& sensor, const Disc& disc, std::span<double> ranges) const noexcept;

 private:
  /// Beams [first, last]; none if first > last.
  struct Window {
    int first, last;
  };
  Window window(const maps::Pose& sensor, const maps::Point& middle, double radius) const noexcept;
  Window gym_window(const maps::Pose& sensor, const Box& box) const noexcept;
  void gym_directions_scan(const Track& track, const maps::Pose& sensor,
                           std::span<float> ranges) const noexcept;

  LidarOptions options_;
  std::vector<double> angles_;
  std::vector<float> cosines_, sines_;            ///< cosines and sines of the angles, padded
  std::vector<float> cone_cosines_, cone_sines_;  ///< the same of the middles of cones of beams, padded
  const detail::ScanKernels* kernels_;
};

}  // namespace slalom::sim
