#pragma once

#include <string>
#include <vector>

#include "slalom/vehicle/model/identification.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

/// Recordings in JSON lines (docs/recording.md) that are read back. All throw IoError with file and line:
/// also if the file is not a regular one (a pipe could block for ever) or larger than 4 GiB, or has a line
/// longer than 4 MiB.
namespace slalom::tools {

/// Reads the control steps of a recording.
std::vector<vehicle::DrivenSample> read_driven_samples(const std::string& file);

/// Reads the line of a recorded drive: its first lap if it comes back to its beginning, else all of it, open.
vehicle::GuideLine driven_line(const std::string& file);

}  // namespace slalom::tools
