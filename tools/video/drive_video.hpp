#pragma once

#include <filesystem>

#include "tools/video/recorded_drive.hpp"

namespace slalom::tools {

/// The part of a recording that a video shows, and how fast.
struct VideoSpan {
  double from = 0, to = 1e9;  ///< s from the beginning of the recording
  double speed = 1;           ///< ratio of recorded to shown time
};

/// Writes a video of a drive from above: samples, guides, plan, cars and obstacles; a second controller
/// stands beside the first. The picture stands still if it can show all of the way, otherwise it follows the
/// car. Returns the number of pictures. Throws IoError, and std::invalid_argument if the span is empty.
int write_video(const RecordedDrive& drive, const VideoSpan& span, const std::filesystem::path& file);

}  // namespace slalom::tools
