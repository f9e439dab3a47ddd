#pragma once

#include "slalom/vehicle/racing/race_course.hpp"
#include "tools/recording/ros_bag.hpp"

/// Recordings that are read back: those of `slalom drive` (docs/recording.md), and bags of rosbag2 in MCAP or
/// sqlite3, as a file or the folder that it writes. All throw IoError with the file: also if it is not a
/// regular one (a pipe could block for ever) or larger than 4 GiB.
namespace slalom::tools {

/// Reads the drive of a recording: what identifies a car, or also the scans.
DrivenRecording read_drive(const std::string& recording, Wanted wanted = Wanted::samples);

/// Reads the line of a recorded drive: its first lap if it comes back to its beginning, else all of it, open.
vehicle::GuideLine driven_line(const std::string& file);

}  // namespace slalom::tools
