#pragma once

#include <filesystem>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/course/course.hpp"

namespace slalom::vehicle::detail {

/// The two formats of a waypoint CSV, or neither.
enum class CsvForm { optimised_line, raceline, other };

/// Detects the format of a CSV from its first lines. Throws IoError if it cannot be read.
CsvForm csv_form(const std::filesystem::path& file);

/// Position and speed of every row; yaw and arc length are left 0. Throws IoError for cells that are not
/// finite numbers, wrong column counts, negative speeds and speeds that are all 0. `lines` gets the line
/// number of every row.
std::vector<Waypoint> read_waypoints(const std::filesystem::path& file, CsvForm form,
                                     std::vector<int>& lines);

/// Columns 0 and 1 of a CSV without header, one point at least.
std::vector<maps::Point> read_points(const std::filesystem::path& file);

}  // namespace slalom::vehicle::detail
