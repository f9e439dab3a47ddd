#pragma once

#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::tracking {

/// A beam that hit something.
struct Reading {
  maps::Point point;  ///< m, frame of the sensor pose
  double range = 0;   ///< m
  int beam = 0;
};

/// The scan of an update with the directions of its beams.
class Readings {
 public:
  Readings(int max_beams, double max_range);  ///< room for scans of `max_beams`

  /// Takes over a scan; false, and no readings, if it is empty, too long or of invalid geometry.
  bool set(const maps::LaserScanView& scan) noexcept;
  /// Computes the points of the readings for a pose of the sensor.
  void place(const maps::Pose& sensor) noexcept;

  /// Readings up to the largest range, in the order of their beams.
  std::span<const Reading> all() const noexcept { return {readings_.data(), count_}; }
  int beams() const noexcept { return beams_; }
  double increment() const noexcept { return increment_; }  ///< rad between beams, above 0
  /// The range of a beam, 0 without a reading, infinite where nothing was hit.
  double range(int beam) const noexcept { return ranges_[beam]; }
  /// The direction of a beam in the frame of the sensor, of length 1.
  maps::Point direction(int beam) const noexcept { return directions_[beam]; }
  /// The beam nearest to a direction in the frame of the sensor (rad); -1 outside the field of view.
  int beam_at(double bearing) const noexcept;
  const maps::Pose& sensor() const noexcept { return sensor_; }

  /// Whether the surface of which `beam` is the last reading in a direction (`step` is -1 or 1) ends there:
  /// what the next beam sees is farther away. False where something nearer may hide the rest, where the
  /// field of view ends, and where the surface goes on.
  bool ends_at(int beam, int step, double min_incidence, double deviation) const noexcept;

 private:
  std::vector<double> ranges_;
  std::vector<maps::Point> directions_;
  std::vector<Reading> readings_;
  std::size_t count_ = 0;
  std::size_t known_directions_ = 0;  ///< computed for the present geometry
  int beams_ = 0;
  double angle_min_ = 0, increment_ = 0, max_range_;
  maps::Pose sensor_;
};

/// m, the distance between readings of neighbouring beams above which a cluster ends: Borges & Aldon (2004),
/// eq. 1, range sin(increment) / sin(lambda - increment) + 3 sigma.
double break_distance(double range, double increment, double min_incidence, double deviation) noexcept;

}  // namespace slalom::tracking
