#pragma once

#include "slalom/vehicle/course/course.hpp"

/// Readers of the files of a course.
namespace slalom::vehicle::detail {

/// The header of a centre line with its widths.
inline constexpr const char* centre_line_header = "# x_m, y_m, w_tr_right_m, w_tr_left_m";

/// The formats of a waypoint CSV (the last: x, y and speed), a centre line with widths, or neither.
enum class CsvForm { optimised_line, raceline, points_with_speed, centre_line, other };

/// Detects the format of a CSV from its first lines. Throws IoError if it cannot be read.
CsvForm csv_form(const std::filesystem::path& file);

/// Position and speed of every row; yaw and arc length are left 0. `lines` gets the rows' line numbers.
/// Throws IoError for cells that are not finite, wrong column counts, negative speeds and speeds that are all
/// 0.
std::vector<Waypoint> read_waypoints(const std::filesystem::path& file, CsvForm form,
                                     std::vector<int>& lines);

/// A row of a centre line.
struct CentreLineRow {
  int number = 0;              ///< line of the file
  double x = 0, y = 0;         ///< m
  double right = 0, left = 0;  ///< m, from the line to the walls; 0 if the file has points only
};

/// The rows of a centre line (see read_centre_line). `widths` becomes whether the file has them.
std::vector<CentreLineRow> read_centre_line_rows(const std::filesystem::path& file, bool& widths);

/// Columns 0 and 1 of a CSV without header, one point at least.
std::vector<maps::Point> read_points(const std::filesystem::path& file);

/// The content of course.yaml; every key is optional.
struct CourseFile {
  std::optional<std::string> name, description;
  std::optional<maps::Pose> start;
  std::optional<double> timeout;  ///< s
  std::optional<bool> closed;
  int start_line = 0;  ///< the line of `start`
};

/// Reads course.yaml. Throws IoError for unknown keys and for values of the wrong type or out of range.
CourseFile read_course_file(const std::filesystem::path& file);

/// Whether a yaml file can be a map: it has the key `image`, or it is not valid YAML, so that
/// loading it as a map reports the error.
bool may_be_map(const std::filesystem::path& file);

}  // namespace slalom::vehicle::detail
