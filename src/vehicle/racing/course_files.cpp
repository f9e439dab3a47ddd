// The files of courses that are made: maps, lines and course.yaml.
#include <cstdio>

#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "vehicle/course/course_readers.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr double jump_steps = 20;  // usual steps, than which a jump is longer
constexpr double jump_turn = 1;    // rad, by which a line turns where it jumps
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

/// Creates the folder and writes what all courses have; `maker` is the command of the program.
void save_course(const fs::path& folder, const maps::OccupancyGrid& map,
                 const std::vector<RacelinePoint>& raceline, int decimals, const std::string& maker,
                 const TrackLabel& label, const maps::Pose& start, bool closed) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError(folder.string(), 0, "cannot be created: " + error.message());
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

/// The number of points after which a line has come back to its first one and follows itself until its end; 0
/// if it does not. `longest` is its longest step, m.
std::size_t overlap_from(const std::vector<maps::Point>& points, double longest) {
  const std::size_t n = points.size();
  const auto apart = [&](std::size_t i, std::size_t k) {
    return std::hypot(points[i].x - points[k].x, points[i].y - points[k].y);
  };
  const double near = std::max(1.5 * longest, 0.3), far = 4 * near;  // m
  std::size_t at = 1;
  while (at < n && apart(at, 0) < far) ++at;
  while (at < n && apart(at, 0) > near) ++at;
  while (at + 1 < n && apart(at + 1, 0) <= apart(at, 0)) ++at;
  if (at + 1 >= n) return 0;
  for (std::size_t k = at; k < n; ++k) {
    bool follows = false;
    for (std::size_t i = 0; i < std::min(k - at + k / 8 + 4, at) && !follows; ++i)
      follows = apart(k, i) <= near;
    if (!follows) return 0;
  }
  const double forwards = (points[at + 1].x - points[at].x) * (points[1].x - points[0].x) +
                          (points[at + 1].y - points[at].y) * (points[1].y - points[0].y);
  if (forwards <= 0) return 0;
  return apart(at, 0) < 0.5 * apart(0, 1) ? at : at + 1;
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

std::size_t find_jump(std::span<const maps::Point> points) {
  if (points.size() < 4) return 0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < points.size(); ++i) steps.push_back(distance(points[i - 1], points[i]));
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double usual = sorted[sorted.size() / 2];
  const auto turn = [&](std::size_t i) {  // at a point that has both neighbours
    const auto yaw = [&](std::size_t k) {
      return std::atan2(points[k + 1].y - points[k].y, points[k + 1].x - points[k].x);
    };
    return std::abs(maps::wrap_angle(yaw(i) - yaw(i - 1)));
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (steps[i - 1] <= jump_steps * usual) continue;
    if ((i > 1 && turn(i - 1) > jump_turn) || (i + 1 < points.size() && turn(i) > jump_turn)) return i;
  }
  return 0;
}

std::string jump_text(std::span<const maps::Point> points, std::size_t jump) {
  return "jumps by " + fixed(distance(points[jump - 1], points[jump]), 1) +
         " m, as a pose that was corrected does; remove the points on one side of the jump";
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
  for (const auto& row : rows) read.line.points.push_back({row.x, row.y});
  if (const std::size_t jump = find_jump(read.line.points); jump > 0)
    throw IoError(file.string(), rows[jump].number, jump_text(read.line.points, jump));
  double longest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) longest = std::max(longest, apart(rows[i - 1], rows[i]));
    if (!widths) continue;
    read.left.push_back(rows[i].left);
    read.right.push_back(rows[i].right);
  }
  read.line.closed = apart(rows.back(), rows.front()) <= 3 * longest;
  if (const std::size_t kept = overlap_from(read.line.points, longest); kept >= 4) {
    read.line.closed = true;
    read.line.note = "the last " + std::to_string(rows.size() - kept) + " of " + std::to_string(rows.size()) +
                     " points follow the first ones again, from (" + fixed(rows[kept].x, 2) + ", " +
                     fixed(rows[kept].y, 2) + ") on; they are left out, and the line is closed there";
    read.line.points.resize(kept);
    if (widths) {
      read.left.resize(kept);
      read.right.resize(kept);
    }
  }
  return read;
}

}  // namespace slalom::vehicle
