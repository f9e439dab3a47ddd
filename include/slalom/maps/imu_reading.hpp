#pragma once

#include <cmath>

namespace slalom {

/// A reading of an inertial measurement unit on a plane, at the centre of gravity, in the body's frame.
struct ImuReading {
  static constexpr double fastest_turn = 100;  ///< rad/s, largest magnitude of a plausible yaw rate
  static constexpr double strongest = 1000;    ///< m/s^2, largest magnitude of a plausible acceleration
  double yaw_rate = 0;                         ///< rad/s, to the left
  double forward = 0;                          ///< m/s^2, acceleration along the body
  double leftward = 0;                         ///< m/s^2, acceleration to the left
};

/// Whether a reading is a number and as large as that of a car may be.
inline bool plausible(const ImuReading& reading) noexcept {
  return std::abs(reading.yaw_rate) <= ImuReading::fastest_turn &&
         std::abs(reading.forward) <= ImuReading::strongest &&
         std::abs(reading.leftward) <= ImuReading::strongest;
}

}  // namespace slalom
