#pragma once

#include <string>

/// The JSON schemas of the Foxglove messages that recordings hold
/// (https://docs.foxglove.dev/docs/visualization/ message-schemas), by which Foxglove and Lichtblick know how
/// to show them.
namespace slalom::view::foxglove {

std::string frame_transform_schema();
std::string grid_schema();
std::string laser_scan_schema();
std::string scene_update_schema();

}  // namespace slalom::view::foxglove
