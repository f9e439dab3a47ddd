#pragma once

namespace slalom {

/// What a driver or a planner asks of a car.
struct Command {
  double steer = 0;  ///< rad, angle of the front wheels, positive to the left
  double speed = 0;  ///< m/s, along the car's axis
};

}  // namespace slalom
