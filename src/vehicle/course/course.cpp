#include "slalom/vehicle/course/course.hpp"

#include "slalom/core/numbers/count.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/maps/ros_map.hpp"
#include "vehicle/course/course_readers.hpp"
#include "vehicle/racing/cell_regions.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr const char* obstacle_file = "opp_ref_path.csv";
constexpr const char* course_file = "course.yaml";
constexpr double origin_spacing = 100000;  // m, as of the planner's origin
constexpr double decimals = 1e8;           // 1 / m, to which coordinates relative to an origin are rounded
constexpr double slowest_profile_speed = 0.1;  // m/s, keeps the time of a profile that stops finite

double distance(const Waypoint& a, const Waypoint& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

/// The files of a folder whose name ends in one of `extensions`, in the order of their names.
std::vector<fs::path> files_with(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<fs::path> files;
  for (fs::path& file : list_folder(folder)) {
    const auto extension = file.extension().string();
    if (std::count(extensions.begin(), extensions.end(), extension) && fs::is_regular_file(file))
      files.push_back(std::move(file));
  }
  return files;
}

std::string names_of(const std::vector<fs::path>& files) {
  std::string names;
  for (const auto& file : files) names += (names.empty() ? "" : ", ") + file.filename().string();
  return names;
}

/// The only candidate, or an error.
const fs::path& only_one(const fs::path& folder, const std::vector<fs::path>& candidates,
                         const std::string& what, const std::string& ignored) {
  if (candidates.empty())
    throw IoError(folder.string(), 0, "holds no " + what + "; a course needs one" + ignored);
  if (candidates.size() > 1)
    throw IoError(
        folder.string(), 0,
        "holds more than one " + what + " (" + names_of(candidates) + "); a course needs exactly one");
  return candidates.front();
}

fs::path find_map(const fs::path& folder, std::vector<std::string>& notes) {
  std::vector<fs::path> candidates;
  std::string ignored;
  for (const auto& file : files_with(folder, {".yaml", ".yml"})) {
    if (file.filename() == course_file) continue;
    if (detail::may_be_map(file)) {
      candidates.push_back(file);
    } else {
      notes.push_back(file.filename().string() + " is ignored: it names no map image");
      ignored += "; " + notes.back();
    }
  }
  return only_one(folder, candidates, "map (a .yaml file with the key image)", ignored);
}

fs::path find_waypoints(const fs::path& folder, detail::CsvForm& form, std::vector<std::string>& notes) {
  using enum detail::CsvForm;
  std::vector<fs::path> candidates, files = files_with(folder, {".csv"});
  std::string ignored;
  std::vector<detail::CsvForm> forms;
  for (const fs::path& file : files)
    forms.push_back(file.filename() == obstacle_file ? centre_line : detail::csv_form(file));
  // Points with a speed count where no file has one of the other forms.
  const bool plain = std::count(forms.begin(), forms.end(), raceline) +
                         std::count(forms.begin(), forms.end(), optimised_line) ==
                     0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const fs::path& file = files[i];
    if (forms[i] == centre_line) continue;
    if (forms[i] != other && (forms[i] != points_with_speed || plain)) {
      candidates.push_back(file);
      form = forms[i];
    } else {
      notes.push_back(file.filename().string() + " is ignored: it is in no form of a waypoint file");
      ignored += "; " + notes.back();
    }
  }
  return only_one(folder, candidates,
                  "waypoint file (a .csv with the header opt_x,opt_y,...,ref_v or x_m; y_m; vx_mps, or rows "
                  "s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2)",
                  ignored);
}

/// Drops a last row that repeats the first; requires at least three points, of which successive ones differ.
void check_points(std::vector<Waypoint>& points, std::vector<int>& lines, const fs::path& file) {
  if (points.size() > 1 && distance(points.front(), points.back()) == 0) {
    points.pop_back();
    lines.pop_back();
  }
  if (points.size() < 3)
    throw IoError(file.string(), 0, std::to_string(points.size()) + " waypoints; at least 3 are needed");
  for (std::size_t i = 1; i < points.size(); ++i)
    if (distance(points[i - 1], points[i]) == 0)
      throw IoError(file.string(), lines[i],
                    "repeats the point of the row before; successive waypoints must differ");
}

/// The column and row of a point of the map frame, in cells.
maps::Point in_cells(const maps::OccupancyGrid& map, const maps::Point& point) {
  const maps::Point at = maps::inverse_transform(map.origin, point);
  return {at.x / map.resolution, at.y / map.resolution};
}

bool on_map(const maps::OccupancyGrid& map, const maps::Point& cell) {
  return cell.x >= 0 && cell.y >= 0 && cell.x < map.width && cell.y < map.height;
}

/// A waypoint may be in a wall, since recorded lines touch walls, but must not be off the map.
void check_on_map(const Course& course, const std::vector<int>& lines, const fs::path& file) {
  for (std::size_t i = 0; i < course.waypoints.size(); ++i) {
    const Waypoint& point = course.waypoints[i];
    if (on_map(course.map, in_cells(course.map, {point.x, point.y}))) continue;
    throw IoError(file.string(), lines[i],
                  "waypoint (" + to_text(point.x) + ", " + to_text(point.y) + ") must be on the map");
  }
}

/// Fills yaw and arc length from the points and returns the longest step between two rows.
double complete(std::vector<Waypoint>& points) {
  double longest = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double step = distance(points[i], points[i + 1]);
    points[i].yaw = std::atan2(points[i + 1].y - points[i].y, points[i + 1].x - points[i].x);
    points[i + 1].arc_length = points[i].arc_length + step;
    longest = std::max(longest, step);
  }
  points.back().yaw = points[points.size() - 2].yaw;
  return longest;
}

/// Adds waypoints on the straight way (m) from the last one to the first, at most `step` (m) apart.
void close_gap(std::vector<Waypoint>& points, double gap, double step) {
  const Waypoint first = points.front(), last = points.back();
  const int pieces = saturate_cast<int>(std::ceil(gap / step));
  for (int k = 1; k < pieces; ++k) {
    const double share = static_cast<double>(k) / pieces;
    Waypoint point{.x = last.x + share * (first.x - last.x),
                   .y = last.y + share * (first.y - last.y),
                   .speed = last.speed + share * (first.speed - last.speed)};
    points.push_back(point);
  }
}

/// Returns the folder of a course's waypoints: that of its map, except for a folder map/NAME with a folder
/// reference_path/NAME beside `map`.
fs::path path_folder(const fs::path& folder) {
  const fs::path map = fs::weakly_canonical(folder), maps = map.parent_path();
  const fs::path path = maps.parent_path() / "reference_path" / map.filename();
  return maps.filename() == "map" && fs::is_directory(path) ? path : folder;
}

}  // namespace

void complete_course(Course& course, std::optional<bool> closed) {
  if (course.waypoints.size() < 3)
    throw std::invalid_argument(std::to_string(course.waypoints.size()) +
                                " waypoints; at least 3 are needed");
  const double longest = complete(course.waypoints);
  const double gap = distance(course.waypoints.back(), course.waypoints.front());
  // The ends of a lap seldom meet exactly: files omit one step or a little more.
  course.closed = closed.value_or(gap <= 3 * longest);
  if (course.closed && gap > 3 * longest) {
    close_gap(course.waypoints, gap, longest);
    complete(course.waypoints);
  }
  const Waypoint &first = course.waypoints.front(), &last = course.waypoints.back();
  course.length = last.arc_length + (course.closed ? distance(last, first) : 0);
  if (!(course.length >= 0.1))
    throw std::invalid_argument("waypoints: " + to_text(course.length) + " m long; must be at least 0.1 m");
  course.start = {first.x, first.y, first.yaw};
  if (course.obstacle_path.empty())
    for (const Waypoint& point : course.waypoints) course.obstacle_path.push_back({point.x, point.y});
}

Course load_course(const fs::path& folder, maps::MapRule rule) {
  if (!fs::is_directory(folder)) throw IoError(folder.string(), 0, "is not a folder");
  const fs::path paths = path_folder(folder);
  Course course{.name = fs::weakly_canonical(folder).filename().string()};
  course.map = maps::load_ros_map(find_map(folder, course.notes), rule, &course.notes);
  detail::CsvForm form = detail::CsvForm::other;
  const fs::path line = find_waypoints(paths, form, course.notes);
  std::vector<int> rows;
  course.waypoints = detail::read_waypoints(line, form, rows);
  check_points(course.waypoints, rows, line);
  check_on_map(course, rows, line);
  if (const fs::path points = paths / obstacle_file; fs::exists(points))
    course.obstacle_path = detail::read_points(points);
  const fs::path file = folder / course_file;
  const detail::CourseFile said = fs::exists(file) ? detail::read_course_file(file) : detail::CourseFile{};
  try {
    complete_course(course, said.closed);
  } catch (const std::invalid_argument& error) {
    throw IoError(line.string(), 0, error.what());
  }
  course.name = said.name.value_or(course.name);
  course.description = said.description.value_or("");
  course.start = said.start.value_or(course.start);
  course.timeout = said.timeout;
  if (said.start) try {
      check_start(course, course.start);
    } catch (const std::invalid_argument& error) {
      throw IoError(file.string(), said.start_line, std::string("key start: ") + error.what());
    }
  return course;
}

void move_to_local_origin(Course& course) {
  const auto nearest = [](double x) { return origin_spacing * std::round(x / origin_spacing); };
  const maps::Point shift{nearest(course.map.origin.x), nearest(course.map.origin.y)};
  if (shift.x == 0 && shift.y == 0) return;
  const auto move = [&](auto& point) {
    point.x = std::round((point.x - shift.x) * decimals) / decimals;
    point.y = std::round((point.y - shift.y) * decimals) / decimals;
  };
  const bool starts_at_first = starts_at_first_waypoint(course);
  maps::Pose start = course.start;
  move(start);
  move(course.map.origin);
  for (Waypoint& point : course.waypoints) move(point);
  for (maps::Point& point : course.obstacle_path) move(point);
  course.origin = {course.origin.x + shift.x, course.origin.y + shift.y};
  complete_course(course, course.closed);
  if (!starts_at_first) course.start = start;
}

maps::OccupancyGrid reachable_map(const Course& course) {
  maps::OccupancyGrid map = course.map;
  const detail::CellRegions free(map.width, map.height, false,
                                 [&](int x, int y) { return map.at(x, y) == maps::Occupancy::free; });
  std::vector<char> reached(free.regions().size(), 0);
  for (const Waypoint& point : course.waypoints) {
    const maps::Point cell = in_cells(map, {point.x, point.y});
    const int column = saturate_cast<int>(std::floor(cell.x), -1),
              row = saturate_cast<int>(std::floor(cell.y), -1);
    if (!map.contains(column, row)) continue;
    if (const int region = free.at(column, row); region >= 0) reached[region] = 1;
  }
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const int region = free.at(column, row);
      if (region >= 0 && !reached[region]) map.at(column, row) = maps::Occupancy::unknown;
    }
  return map;
}

void cap_speed(Course& course, double max_speed) {
  if (!(max_speed > 0))
    throw std::invalid_argument("max_speed: " + to_text(max_speed) + " must be above 0 m/s");
  for (Waypoint& point : course.waypoints) point.speed = std::min(point.speed, max_speed);
}

double profile_time(const Course& course) {
  const auto& points = course.waypoints;
  double time = 0;
  const auto stretch = [&](const Waypoint& a, const Waypoint& b) {
    return distance(a, b) / std::max(0.5 * (a.speed + b.speed), slowest_profile_speed);
  };
  for (std::size_t i = 1; i < points.size(); ++i) time += stretch(points[i - 1], points[i]);
  if (course.closed && points.size() > 1) time += stretch(points.back(), points.front());
  return time;
}

bool starts_at_first_waypoint(const Course& course) noexcept {
  const Waypoint& first = course.waypoints.front();
  return course.start.x == first.x && course.start.y == first.y && course.start.yaw == first.yaw;
}

void check_start(const Course& course, const maps::Pose& start, double clearance) {
  maps::check_pose("start", start);
  const auto refuse = [&](const std::string& rule) {
    throw std::invalid_argument("start (" + to_text(start.x) + ", " + to_text(start.y) + ", " +
                                to_text(start.yaw) + ") " + rule);
  };
  const auto& map = course.map;
  const auto [column, row] = in_cells(map, {start.x, start.y});
  if (!on_map(map, {column, row})) refuse("must be on the map");
  const int reach = static_cast<int>(count(clearance, map.resolution, 1e4, "start: clearance"));
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const int x = saturate_cast<int>(column) + dx, y = saturate_cast<int>(row) + dy;
      const double apart = std::hypot(x + 0.5 - column, y + 0.5 - row) * map.resolution;
      if ((apart <= clearance || (dx == 0 && dy == 0)) && map.contains(x, y) &&
          map.at(x, y) == maps::Occupancy::occupied)
        refuse("must have a distance to every wall of at least " + to_text(clearance) + " m");
    }
}

}  // namespace slalom::vehicle
