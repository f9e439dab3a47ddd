#pragma once

#include <string>

#include "slalom/vehicle/racing/race_course.hpp"

namespace slalom::tools {

/// The line of a recorded drive (see read_driven_samples): its first lap if it comes back to its beginning,
/// else all of it, open. Throws IoError with file and line.
vehicle::GuideLine driven_line(const std::string& file);

}  // namespace slalom::tools
