#pragma once

#include <span>
#include <vector>

#include "slalom/sim/car.hpp"
#include "slalom/sim/lidar.hpp"

namespace slalom::sim {

/// f1tenth_gym's test for a wall hit: a beam whose range, less the way to the car's outline, is used up in
/// less than 5 ms at the present speed. The outline is taken (l_f + l_r) / 2 ahead and behind instead of half
/// a length, a range inside it ahead of the car does not count, and at speed the car moves farther per step
/// than the test looks. Exact collisions come from Track::collides_with_wall.
class TimeToCollision {
 public:
  /// Computed for a scanner on a car.
  TimeToCollision(const LidarOptions& lidar, const CarParameters& car);

  /// The first beam that says so, -1 if none does.
  int first_hit(std::span<const double> ranges, double speed) const noexcept;
  /// The first beam with a time to collision below the limit, or -1.
  int first_hit(std::span<const float> ranges, double speed) const noexcept;

  /// The way (m) from the centre of gravity to the car's outline, one per beam.
  std::span<const double> sides() const noexcept { return sides_; }
  /// Cosines of the beam angles.
  std::span<const double> cosines() const noexcept { return cosines_; }

 private:
  std::vector<double> cosines_, sides_;
};

}  // namespace slalom::sim
