#pragma once

#include <array>

#include "slalom/vehicle/model/single_track_dynamics.hpp"

namespace slalom::vehicle::detail {

/// A grid of hypotheses about car and ground.
struct HypothesisGrid {
  static constexpr int delays = 9;      ///< number of steering delays
  static constexpr int gains = 5;       ///< number of steering gains
  static constexpr int frictions = 16;  ///< a multiple of the lanes of any instruction set
  static constexpr int count = delays * gains * frictions;
  std::array<float, gains> gain;
  std::array<float, frictions> friction;
};

/// A stretch of driving, which begins at the origin.
struct Stretch {
  static constexpr int max_steps = 40;
  int steps = 0;
  float period = 0;  ///< s, a step
  /// rad, of the wheels at gain 1, [step][delay]
  std::array<std::array<float, HypothesisGrid::delays>, max_steps + 1> angle;
  std::array<float, max_steps + 1> speed;     ///< m/s, as measured
  std::array<float, max_steps> acceleration;  ///< m/s^2
  float offset = 0;                           ///< rad, added to the angles
  float yaw_rate = 0, lateral = 0;            ///< rad/s, m/s, at the begin
  float x = 0, y = 0, yaw = 0;                ///< m, m, rad, the pose at the end as measured
};

/// Predicts the stretch with every hypothesis. Writes the errors of the predicted position across the car (m)
/// and yaw (rad), [delay][gain][friction].
void predict_all(const SingleTrackDynamics& dynamics, const HypothesisGrid& grid, const Stretch& stretch,
                 float* lateral_error, float* yaw_error) noexcept;

}  // namespace slalom::vehicle::detail
