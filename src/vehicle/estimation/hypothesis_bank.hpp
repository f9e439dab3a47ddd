#pragma once

#include "slalom/vehicle/model/single_track_dynamics.hpp"

namespace slalom::vehicle::detail {

/// A stretch of driving and the hypotheses that predict it. It begins at the origin.
struct BankInput {
  const SingleTrackDynamics* dynamics = nullptr;
  int steps = 0;
  float period = 0;  ///< s, a step
  int delays = 0, gains = 0, frictions = 0;
  const float* angles = nullptr;        ///< rad, [steps + 1][delay], of the wheels at gain 1
  const float* gain = nullptr;          ///< [gain]
  const float* friction = nullptr;      ///< [friction], a multiple of 16
  const float* speed = nullptr;         ///< m/s, [steps + 1], as measured
  const float* acceleration = nullptr;  ///< m/s^2, [steps]
  float yaw_rate = 0, lateral = 0;      ///< rad/s, m/s, at the begin
  float x = 0, y = 0, yaw = 0;          ///< m, m, rad, the pose at the end as measured
  float* lateral_error = nullptr;       ///< m, [delay][gain][friction]
  float* yaw_error = nullptr;           ///< rad, [delay][gain][friction]
};

/// Predicts the stretch with every hypothesis.
void predict_all(const BankInput& input) noexcept;

}  // namespace slalom::vehicle::detail
