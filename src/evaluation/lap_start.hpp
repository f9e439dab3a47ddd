#pragma once

#include <cstdint>
#include <vector>

#include "evaluation/driver/car_driver.hpp"

namespace slalom::evaluation {

/// Makes the drive of a lap: places the obstacles, whose poses are returned in `obstacles`, and puts the cars
/// at their starts.
CarDrive start_lap(const LapSetup& setup, std::uint64_t seed, std::vector<maps::Pose>& obstacles);

}  // namespace slalom::evaluation
