#pragma once

namespace slalom {

/// What an inertial measurement unit reports of a car on a plane, at the centre of gravity, in the body's
/// frame.
struct ImuReading {
  double yaw_rate = 0;  ///< rad/s, to the left
  double forward = 0;   ///< m/s^2, acceleration along the body
  double leftward = 0;  ///< m/s^2, acceleration to the left
};

}  // namespace slalom
