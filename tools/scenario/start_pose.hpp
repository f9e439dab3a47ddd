#pragma once

#include <string>

#include "slalom/maps/pose.hpp"

namespace slalom::tools {

/// The value x,y,yaw (m, m, rad) of --start. Throws IoError.
maps::Pose parse_start(const std::string& text);

}  // namespace slalom::tools
