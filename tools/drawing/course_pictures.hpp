#pragma once

#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/course/track_generator.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

/// Pictures of courses from above, written as PNG, SVG or PDF by the ending of the file. All throw IoError.
namespace slalom::tools {

/// The line that a car has driven.
struct DrivenLine {
  std::vector<maps::Point> points;  ///< path of the centre of gravity, map frame
  std::vector<double> speeds;       ///< m/s
};

/// Draws a lap: map, path, obstacles, driven line coloured by speed, and collisions.
void draw_lap(const maps::OccupancyGrid& map, const evaluation::LapSetup& setup, const DrivenLine& driven,
              const evaluation::LapResult& lap, const std::string& title, const std::filesystem::path& file);

/// Draws plans beside a drive: map, path, driven line coloured by speed, and the plans from points of it.
void draw_plans(const maps::OccupancyGrid& map, const evaluation::LapSetup& setup, const DrivenLine& driven,
                const std::vector<std::vector<maps::Point>>& plans, const std::string& title,
                const std::filesystem::path& file);

/// Draws a course to check it by: map, corridor, centre line, raceline coloured by speed, start, the place
/// nearest to a wall and the tightest curve.
void draw_course(const vehicle::RaceCourse& course, const vehicle::RacingCar& car, const std::string& title,
                 const std::filesystem::path& file);

/// Draws a generated track: map, centre line, raceline coloured by speed, start.
void draw_track(const vehicle::GeneratedTrack& track, const std::string& title,
                const std::filesystem::path& file);

}  // namespace slalom::tools
