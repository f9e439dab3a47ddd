#pragma once

#include <span>
#include <vector>

#include "slalom/sim/car.hpp"
#include "slalom/sim/lidar.hpp"

namespace slalom::sim {

/// f1tenth_gym's test for a wall hit: at the present speed, the car would cover the range of a beam, less the
/// distance to the car's outline, in less than 5 ms. The outline is assumed (l_f + l_r) / 2 ahead and behind
/// instead of half a length, ranges within it ahead of the car do not count, and a fast car moves further in
/// a step than the test covers. Track::collides_with_wall computes exact collisions.
class TimeToCollision {
 public:
  TimeToCollision(const LidarOptions& lidar, const CarParameters& car);  ///< computed for a scanner on a car

  /// The first beam with a time to collision below the limit, -1 if there is none.
  int first_hit(std::span<const double> ranges, double speed) const noexcept;

  /// The way (m) from the centre of gravity to the car's outline, one per beam.
  std::span<const double> sides() const noexcept { return sides_; }
  std::span<const double> cosines() const noexcept { return cosines_; }  ///< cosines of the beam angles

 private:
  std::vector<double> cosines_, sides_;
};

}  // namespace slalom::sim
