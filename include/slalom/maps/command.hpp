#pragma once

namespace slalom {

/// A command of a driver or a planner to a car.
struct Command {
  double steer = 0;  ///< rad, angle of the front wheels, positive to the left
  double speed = 0;  ///< m/s, along the car's axis
};

}  // namespace slalom
