#pragma once

#include <filesystem>
#include <string>

#include "slalom/vehicle/course/track_generator.hpp"

namespace slalom::tools {

/// Draws a track: map, centre line, raceline coloured by speed, start. Writes PNG, SVG or PDF; throws
/// IoError.
void draw_track(const vehicle::GeneratedTrack& track, const std::string& title,
                const std::filesystem::path& file);

}  // namespace slalom::tools
