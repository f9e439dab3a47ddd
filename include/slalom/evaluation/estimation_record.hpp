#pragma once

#include <vector>

#include "slalom/vehicle/estimation/parameter_estimator.hpp"

namespace slalom::evaluation {

/// How well the planner knew state and parameters in a lap; empty where its model has no tyres that slip.
struct EstimationRecord {
  std::vector<float> yaw_rate_error;  ///< rad/s, of each control step, absolute
  std::vector<float> slip_error;      ///< rad, the same
  std::vector<float> speed_error;     ///< m/s, the same
  vehicle::ParameterEstimate last;    ///< estimate of car and ground at the end of the lap
  double informed_time = -1;          ///< s, when the confidence first reached 0.5; -1 if never
};

}  // namespace slalom::evaluation
