#pragma once

#include <cmath>

#include "slalom/vehicle/model/identification.hpp"
#include "support/promise.hpp"

/// The promise of an identification for any samples.
namespace slalom::testing {

/// Throws Finding unless all estimates are finite and no deviation is negative.
inline void check_identification(const vehicle::Identification& found) {
  for (const vehicle::Identified& each : {found.steering_gain, found.steering_offset, found.delay,
                                          found.time_constant, found.wheelbase, found.understeer})
    require(std::isfinite(each.value) && each.deviation >= 0,
            "estimates are finite, deviations are not negative");
  require(std::isfinite(found.speed_scale) && std::isfinite(found.residual) && found.explained <= 1,
          "what is explained is finite");
}

}  // namespace slalom::testing
