#pragma once

#include "slalom/core/options.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/sim/shapes.hpp"
#include "slalom/sim/track.hpp"

namespace slalom::sim {

/// Options of a LiDAR scanner on a car. `visit_options` below describes the fields.
struct LidarOptions {
  int beams = 1080;
  double field_of_view = 4.7;
  double range_max = 30;
  double noise = 0.01;
  double dropout = 0;
  double rate = 0;                  ///< rounded to whole time steps
  maps::Pose mount{0.10355, 0, 0};  ///< pose of the sensor on the car, from the centre of gravity
  /// As f1tenth_gym: ranges are found in steps between the middles of cells, in directions from a table,
  /// their noise is that of numpy, and few beams see other cars. Only for a world with WorldOptions::gym.
  bool gym = false;

  /// The Hokuyo UTM-30LX by its data sheet: 1081 beams in 270 degrees, 40 Hz, 30 m, 10 mm of noise (to 10 m).
  static LidarOptions hokuyo_utm_30lx();

  double angle_increment() const { return beams > 1 ? field_of_view / (beams - 1) : 0; }  ///< rad
  double angle_min() const { return beams > 1 ? -field_of_view / 2 : 0; }                 ///< rad
};

template <class Options, class Visit>
requires is_options_of<Options, LidarOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.beams, {"beams", "", "number of beams of the LiDAR", 1, 100000});
  visit(o.field_of_view,
        {"field_of_view", "rad", "angle between the outermost beams", 0, 2 * std::numbers::pi});
  visit(o.range_max, {"range_max", "m", "longer ranges read range_max", 1e-3, 1e4});
  visit(o.noise, {"noise", "m", "standard deviation of each range", 0, 100});
  visit(o.dropout, {"dropout", "", "fraction of beams without a return: range_max", 0, 1});
  visit(o.rate, {"scan_rate", "Hz", "scans of the LiDAR per second; 0: one in every step", 0, 1e6});
}

/// A planar laser scanner. By default a range is exact: to the outline of the first wall cell on the beam,
/// found by steps that the clearance of each cell allows (sphere tracing, J. C. Hart, 1996), for 16
/// neighbouring beams together as long as they are close to each other, and from cell to cell where it allows
/// none. In SIMD lanes over beams; every instruction set gives the same bits.
class Lidar {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit Lidar(const LidarOptions& options);

  const LidarOptions& options() const noexcept { return options_; }    ///< the options given at construction
  std::span<const double> angles() const noexcept { return angles_; }  ///< rad, in the sensor's frame
  /// Ranges are written to arrays of this size: beams, then padding of no meaning.
  std::size_t padded_beams() const noexcept { return cosines_.size(); }

  maps::Pose sensor_pose(const maps::Pose& car) const noexcept;  ///< the pose of the sensor of a car at `car`

  /// The distances (m) to the walls of the track from a sensor at `sensor`, without noise; padded_beams()
  /// values. From outside the map they are 0 if the outside of the track is wall, else range_max.
  void scan(const Track& track, const maps::Pose& sensor, std::span<float> ranges) const noexcept;

  /// Shortens ranges (padded_beams() values) to a body where it is nearer. Looks only at beams that may hit.
  void cast(const maps::Pose& sensor, const Box& box, std::span<float> ranges) const noexcept;
  /// Shortens ranges (m) to a disc where it is nearer.
  void cast(const maps::Pose& sensor, const Disc& disc, std::span<float> ranges) const noexcept;

  /// Like `scan`, as f1tenth_gym computes it, in float64; one value per beam.
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
  void cast_body(const maps::Pose& sensor, double half_length, double half_width, double radius, Window beams,
                 std::span<float> ranges) const noexcept;
  Window gym_window(const maps::Pose& sensor, const Box& box) const noexcept;
  template <class Body>
  void gym_shorten(const maps::Pose& sensor, const Body& body, Window beams,
                   std::span<double> ranges) const noexcept;

  LidarOptions options_;
  std::vector<double> angles_;
  std::vector<float> cosines_, sines_;            ///< cosines and sines of the angles, padded
  std::vector<float> cone_cosines_, cone_sines_;  ///< the same of the middles of cones of beams, padded
};

/// A stream of normal noise for each (seed, car). The values of call n do not depend on other streams, and
/// are the same on every machine and instruction set.
///
/// Random bits by a counter and two rounds of a multiply-and-shift hash, then the transform of Box & Muller
/// (1958) in float32; the tails reach 5.9 standard deviations.
class NormalNoise {
 public:
  void reset(std::uint64_t seed, std::uint64_t car) noexcept;  ///< the stream of one car of one run

  /// Adds noise of the given standard deviation (m) to the first `count` ranges and cuts them to [0, most].
  /// Ranges of `most` have no return to be noisy; a `dropout` share of the others is lost and becomes `most`.
  /// The array has Lidar::padded_beams() values.
  void add(std::span<float> ranges, int count, double deviation, double most, double dropout);

 private:
  std::uint64_t key_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace slalom::sim
