#pragma once

#include "slalom/tracking/predictor_options.hpp"
#include "slalom/tracking/tracker_options.hpp"

namespace slalom::tracking {

/// Options of a tracker of people on foot, each of them a round body 0.5 m across, in scans of a mobile robot
/// with a noise of about 0.01 m. Anything slower than 0.25 m/s stands.
inline TrackerOptions people_tracker_options() {
  return {.min_points = 3,
          .length = 0.5,
          .width = 0.5,
          .size_deviation = 0.03,
          .max_speed = 3,
          .acceleration_deviation = 1,
          .max_unseen_time = 1,
          .free_margin = 0.1,
          .min_speed = 0.25};
}

/// Options of a predictor of people on foot, as far ahead as a mobile robot plans.
inline PredictorOptions people_predictor_options() {
  return {.horizon = 2.8, .min_speed = 0.25, .braking = 1.5, .acceleration_deviation = 0.2};
}

}  // namespace slalom::tracking
