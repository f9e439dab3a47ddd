#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slalom/evaluation/lap.hpp"
#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::tools {

/// The line a car has driven.
struct DrivenLine {
  std::vector<maps::Point> points;  ///< path of the centre of gravity, map frame
  std::vector<double> speeds;       ///< m/s
};

/// The content of a picture of a lap.
struct LapPicture {
  const maps::OccupancyGrid& map;
  const std::vector<maps::ReferencePoint>& path;
  bool closed = true;  ///< the path is a loop
  const DrivenLine& driven;
  const evaluation::LapResult& lap;
  maps::Pose start;
  std::string title, facts;
};

/// Draws map, path, obstacles, driven line coloured by speed, and collisions. Writes PNG, SVG or PDF; throws
/// IoError.
void draw_lap(const LapPicture& picture, const std::filesystem::path& file);

}  // namespace slalom::tools
