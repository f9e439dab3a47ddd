#pragma once

#include <filesystem>
#include <string>

#include "slalom/vehicle/racing/race_course.hpp"

namespace slalom::tools {

/// Draws a course to check it by: map, corridor, centre line, raceline coloured by speed, start, the place
/// nearest to a wall and the tightest curve. Writes PNG, SVG or PDF; throws IoError.
void draw_course(const vehicle::RaceCourse& course, const vehicle::RacingCar& car, const std::string& title,
                 const std::filesystem::path& file);

}  // namespace slalom::tools
