// The files of courses that are made: maps, lines and course.yaml.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "slalom/core/error.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "vehicle/course/course_csv.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr int track_decimals = 4;
constexpr int race_decimals = 6;  // curvatures are second differences of the coordinates

/// Returns a number with this many decimals, never "-0".
std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  const std::string result = text;
  // "-0.0000" and "0.0000" are the same number and must be the same bytes.
  return result.find_first_of("123456789") == std::string::npos && result.front() == '-' ? result.substr(1)
                                                                                         : result;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + '"';
}

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw IoError(file.string(), 0, "cannot be written");
}

/// Creates the folder and writes what all courses have; `maker` is the command of the program.
void save_course(const fs::path& folder, const maps::OccupancyGrid& map,
                 const std::vector<RacelinePoint>& raceline, int decimals, const std::string& maker,
                 const TrackLabel& label, const maps::Pose& start, bool closed) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) throw IoError(folder.string(), 0, "cannot create the folder");
  maps::save_ros_map(map, folder / "map.yaml");
  std::string text = "# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n";
  for (const RacelinePoint& point : raceline) {
    for (const double value : {point.arc_length, point.x, point.y, point.yaw, point.curvature, point.speed})
      text += fixed(value, decimals) + "; ";
    text += fixed(point.acceleration, decimals) + "\n";
  }
  write_file(folder / "raceline.csv", text);
  write_file(folder / "course.yaml",
             "# Made by `slalom " + maker +
                 "`; the command below makes it again.\nname: " + quoted(label.name) +
                 "\ndescription: " + quoted(label.description) + "\ncommand: " + quoted(label.command) +
                 "\nstart: {x: " + fixed(start.x, 4) + ", y: " + fixed(start.y, 4) +
                 ", yaw: " + fixed(start.yaw, 4) + "}\nclosed: " + (closed ? "true" : "false") + "\n");
}

}  // namespace

void save_track(const GeneratedTrack& track, const fs::path& folder, const TrackLabel& label) {
  const RacelinePoint& first = track.raceline.front();
  save_course(folder, track.map, track.raceline, track_decimals, "track", label,
              {first.x, first.y, first.yaw}, true);
  std::string obstacles;
  for (const maps::Point& point : track.obstacle_path)
    obstacles += fixed(point.x, track_decimals) + "," + fixed(point.y, track_decimals) + "\n";
  write_file(folder / "opp_ref_path.csv", obstacles);
}

void save_race_course(const RaceCourse& course, const fs::path& folder, const TrackLabel& label) {
  const Corridor& corridor = course.corridor;
  save_course(folder, course.map, course.raceline.points, race_decimals, "course", label, course.start,
              corridor.closed);
  std::string text = detail::centre_line_header + std::string("\n");
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i)
    text += fixed(corridor.centre_line[i].x, race_decimals) + ", " +
            fixed(corridor.centre_line[i].y, race_decimals) + ", " + fixed(corridor.right[i], race_decimals) +
            ", " + fixed(corridor.left[i], race_decimals) + "\n";
  write_file(folder / "centerline.csv", text);
}

CentreLineFile read_centre_line(const std::filesystem::path& file) {
  bool widths = false;
  auto rows = detail::read_centre_line_rows(file, widths);
  const auto apart = [](const detail::CentreLineRow& a, const detail::CentreLineRow& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
  };
  // Equal points have no direction between them; a last row may repeat the first.
  rows.erase(
      std::unique(rows.begin(), rows.end(), [&](const auto& a, const auto& b) { return apart(a, b) == 0; }),
      rows.end());
  if (rows.size() > 1 && apart(rows.front(), rows.back()) == 0) rows.pop_back();
  if (rows.size() < 4)
    throw IoError(file.string(), 0, std::to_string(rows.size()) + " points; a centre line needs at least 4");
  CentreLineFile read;
  double longest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) longest = std::max(longest, apart(rows[i - 1], rows[i]));
    read.line.points.push_back({rows[i].x, rows[i].y});
    if (!widths) continue;
    read.left.push_back(rows[i].left);
    read.right.push_back(rows[i].right);
  }
  read.line.closed = apart(rows.back(), rows.front()) <= 3 * longest;
  return read;
}

}  // namespace slalom::vehicle
