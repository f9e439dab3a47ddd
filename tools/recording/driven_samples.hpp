#pragma once

#include <string>
#include <vector>

#include "slalom/vehicle/model/identification.hpp"

namespace slalom::tools {

/// The ticks of a ROS 1 bag, or of a recording in JSON lines (docs/recording.md). Throws IoError with file
/// and line.
std::vector<vehicle::DrivenSample> read_driven_samples(const std::string& file);

}  // namespace slalom::tools
