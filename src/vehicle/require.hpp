#pragma once

#include "slalom/core/option_access.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"

namespace slalom::vehicle::detail {

/// Throws std::invalid_argument, "KEY: VALUE must be RULE", unless `holds`.
inline void require(bool holds, const std::string& key, double value, const std::string& rule) {
  if (!holds) throw std::invalid_argument(key + ": " + to_text(value) + " must be " + rule);
}

/// The same unless a value is in a range.
inline void require_within(double low, double high, const std::string& key, double value) {
  require(value >= low && value <= high, key, value, "within " + to_text(low) + " to " + to_text(high));
}

/// Speeds and accelerations that a car can have, m/s and m/s^2.
inline void require_plausible(const SpeedLimits& limits) {
  require_within(0.01, 1000, "top_speed", limits.top_speed);
  require_within(0.01, 1000, "lateral_acceleration", limits.lateral_acceleration);
  require_within(0.01, 1000, "acceleration", limits.acceleration);
  require_within(0.01, 1000, "braking", limits.braking);
}

/// The curvatures (1/m) of a path, and its steps (m).
inline void require_finite(std::span<const double> curvature, std::span<const double> step) {
  if (step.size() != curvature.size())
    throw std::invalid_argument("path: curvature and step must have the same size");
  for (std::size_t i = 0; i < step.size(); ++i) {
    require(std::isfinite(curvature[i]), "curvature " + std::to_string(i), curvature[i], "finite");
    require(step[i] >= 0 && std::isfinite(step[i]), "step " + std::to_string(i), step[i],
            "finite and at least 0");
  }
}

}  // namespace slalom::vehicle::detail
