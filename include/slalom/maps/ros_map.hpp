#pragma once

#include <filesystem>
#include <string>

#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::maps {

/// How grey becomes occupancy.
enum class MapRule {
  /// As ROS map_server: with p = (255 - grey) / 255 (grey / 255 with `negate`) a cell is occupied where
  /// p > occupied_thresh, free where p < free_thresh, else unknown. In mode `raw` the grey value itself is
  /// the occupancy in percent.
  map_server,
  /// As f1tenth_gym: a grey of at most 128 is an obstacle, all else free, unknown cells too; `negate`, `mode`
  /// and the thresholds of the yaml file are neither used nor needed.
  grey_threshold,
};

/// Loads a map of ROS map_server: a yaml file with `image` (relative to it), `resolution` (m per pixel),
/// `origin` [x, y, yaw] of the lower left corner (m, m, rad), `negate`, `occupied_thresh`, `free_thresh` and,
/// if present, `mode` (trinary, scale, raw). The grid keeps three states: values of `scale` and `raw` between
/// free (0) and occupied (100) are unknown, as in AMCL, and so are, with MapRule::map_server, pixels less
/// than half opaque. With MapRule::map_server, the grey 205 of map_saver is also unknown where `free_thresh`
/// would make it free, if at least 1 % of the pixels have it and others are lighter; `notes` then receives a
/// sentence. Throws IoError if a file cannot be read or breaks a rule.
OccupancyGrid load_ros_map(const std::filesystem::path& yaml_file, MapRule rule = MapRule::map_server,
                           std::vector<std::string>* notes = nullptr);

/// Writes `yaml_file` and, beside it, a PNG of the same name, with the greys and thresholds of map_saver.
/// Throws IoError if a file cannot be written or the grid is too large for an image (image.hpp), and as
/// check_grid does.
void save_ros_map(const OccupancyGrid& grid, const std::filesystem::path& yaml_file);

}  // namespace slalom::maps
