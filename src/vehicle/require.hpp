#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "slalom/vehicle/course/speed_profile.hpp"

namespace slalom::vehicle::detail {

/// Throws std::invalid_argument, "KEY: VALUE must be RULE", unless `holds`.
inline void require(bool holds, const std::string& key, double value, const std::string& rule) {
  if (!holds) throw std::invalid_argument(key + ": " + std::to_string(value) + " must be " + rule);
}

inline void require_positive(const std::string& key, double value) {
  require(value > 0 && std::isfinite(value), key, value, "finite and above 0");
}

inline void require_positive(const SpeedLimits& limits) {
  require_positive("top_speed", limits.top_speed);
  require_positive("lateral_acceleration", limits.lateral_acceleration);
  require_positive("acceleration", limits.acceleration);
  require_positive("braking", limits.braking);
}

}  // namespace slalom::vehicle::detail
