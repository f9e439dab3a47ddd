#pragma once

#include <string>
#include <vector>

#include "slalom/vehicle/model/identification.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

/// Recordings that are read back: those of `slalom drive` (docs/recording.md), and bags of rosbag2 in MCAP or
/// sqlite3, as a file or the folder that it writes. All throw IoError with the file: also if it is not a
/// regular one (a pipe could block for ever) or larger than 4 GiB.
namespace slalom::tools {

/// Reads the control steps of a recording. Of a bag, `topics` receives which topics were used (RosDrive).
std::vector<vehicle::DrivenSample> read_driven_samples(const std::string& recording,
                                                       std::string* topics = nullptr);

/// Reads the line of a recorded drive: its first lap if it comes back to its beginning, else all of it, open.
vehicle::GuideLine driven_line(const std::string& file);

}  // namespace slalom::tools
