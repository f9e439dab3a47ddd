#pragma once

#include <optional>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/ros_map.hpp"

namespace slalom::vehicle {

/// A point of the reference path and the speed there.
struct Waypoint {
  double x = 0;           ///< m, map frame
  double y = 0;           ///< m, map frame
  double yaw = 0;         ///< rad, direction to the next row; the last row has that of the row before it
  double speed = 0;       ///< m/s, >= 0
  double arc_length = 0;  ///< m along the rows, 0 at the first
};

/// A place to drive: a map, a path with a speed profile, and a start.
///
/// A course is a folder with one ROS map (a yaml file and the image it names) and one waypoint CSV in one of
/// two formats:
///  - a header `opt_x,opt_y,...,ref_v` and comma-separated rows; the columns opt_x, opt_y and ref_v are read;
///  - leading lines that begin with `#`, then rows `s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2`;
///    x_m, y_m and vx_mps are read.
/// The yaw is computed from the points, since files differ in the axis from which they measure it.
/// `opp_ref_path.csv`, if present, has no header; its columns 0 and 1 are the points where obstacles may
/// stand. `course.yaml`, if present, may give `name`, `description`, `command`, `start` {x, y, yaw},
/// `timeout` (s), `closed`.
///
/// The program of Honda et al. (ICRA 2024) has its files in two folders: a map in `map/NAME`, the CSV files
/// in `reference_path/NAME`. There, `map/NAME` is the folder of the course.
struct Course {
  std::string name{};         ///< the name
  std::string description{};  ///< one sentence
  maps::Point origin{};       ///< m, map frame; origin of the coordinates below
  maps::OccupancyGrid map{};  ///< the map
  /// At least 3; successive ones differ, and the first is not repeated at the end.
  std::vector<Waypoint> waypoints{};
  std::vector<maps::Point> obstacle_path{};  ///< where obstacles are placed; without a file the waypoints
  maps::Pose start{};  ///< pose of the centre of gravity: course.yaml has it, else the first waypoint
  std::optional<double> timeout{};   ///< s per lap, if course.yaml gives one
  bool closed = true;                ///< the path continues from the last waypoint to the first
  double length = 0;                 ///< m along the waypoints, with the closing stretch if closed
  std::vector<std::string> notes{};  ///< things that were ignored and why, one sentence each
};

/// Loads and checks the course in `folder`; `reading` has the options for its map. Throws IoError naming
/// file, line, column or key, value and rule.
Course load_course(const std::filesystem::path& folder, maps::MapRule rule = maps::MapRule::map_server);

/// Computes from the waypoints' points their yaw and arc length, the course's length, its start, whether it
/// is closed unless `closed` has a value, and its obstacle path if it has none. Throws std::invalid_argument
/// on fewer than 3 points.
void complete_course(Course& course, std::optional<bool> closed = {});

/// Makes the coordinates relative to `origin`, the point of a 100 km grid of the map frame that is nearest to
/// the map's corner, and rounds them to 1e-8 m. So a simulated lap in UTM coordinates, which double resolves
/// to 1e-9 m, is the same as near the origin of the map frame, where a course does not change.
void move_to_local_origin(Course& course);

/// The map of a course for a Localiser: free cells that no way over free cells joins to a waypoint are
/// unknown. Many maps are free outside of the walls, where the car cannot be.
maps::OccupancyGrid reachable_map(const Course& course);

/// Lowers every waypoint's speed to at most `max_speed` (m/s, > 0, else std::invalid_argument).
void cap_speed(Course& course, double max_speed);

/// The time to drive once along the waypoints at their speeds, s. A segment is driven at the mean of the
/// speeds at its ends, but at 0.1 m/s at least.
double profile_time(const Course& course);

/// Whether the start is the pose of the first waypoint.
bool starts_at_first_waypoint(const Course& course) noexcept;

/// Throws std::invalid_argument unless `start` is finite, on the map, and this far (m) from occupied cells.
void check_start(const Course& course, const maps::Pose& start, double clearance = 0.15);

/// The folders in which courses are searched by name: SLALOM_COURSES_DIR if set, then, relative to the folder
/// of the running program, a `courses` with known.yaml in that folder or up to four above it (the
/// source tree it was built in), and the install's share/slalom/courses. Only those that exist.
std::vector<std::filesystem::path> course_roots(const std::filesystem::path& program_folder);

/// The folder of a course: `name_or_folder` itself if it is a folder, else the first `root/name_or_folder`
/// that is one. Throws IoError that names the folders searched and the courses found.
std::filesystem::path find_course(const std::string& name_or_folder,
                                  const std::vector<std::filesystem::path>& roots);

/// The names of the courses in `roots`, sorted, without duplicates.
std::vector<std::string> course_names(const std::vector<std::filesystem::path>& roots);

/// Start and timeout that the evaluation of the paper prescribes for one of its courses.
struct KnownCourse {
  maps::Pose start;    ///< start pose of the centre of gravity, m, m, rad
  double timeout = 0;  ///< s per lap
};

/// The entry for `name` of the table `known.yaml` in the first of `roots` that has one.
std::optional<KnownCourse> known_course(const std::string& name,
                                        const std::vector<std::filesystem::path>& roots);

}  // namespace slalom::vehicle
