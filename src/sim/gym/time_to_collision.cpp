#include "slalom/sim/time_to_collision.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::sim {

TimeToCollision::TimeToCollision(const LidarOptions& lidar, const CarParameters& car) {
  constexpr double quarter = 1.5707963267948966;
  const double side = car.width / 2, front = (car.front_length + car.rear_length) / 2;
  for (int i = 0; i < lidar.beams; ++i) {
    const double angle = lidar.angle_min() + i * lidar.angle_increment(), turn = std::abs(angle);
    cosines_.push_back(std::cos(angle));
    sides_.push_back(turn < quarter
                         ? std::min(side / std::sin(turn), front / std::cos(turn))
                         : std::min(side / std::cos(turn - quarter), front / std::sin(turn - quarter)));
  }
}

int TimeToCollision::first_hit(std::span<const double> ranges, double speed) const noexcept {
  constexpr double soon = 0.005;  // s
  if (speed == 0) return -1;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double time = (ranges[i] - sides_[i]) / (speed * cosines_[i]);
    if (time < soon && time >= 0) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace slalom::sim
