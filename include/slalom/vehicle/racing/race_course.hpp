#pragma once

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/course/track_generator.hpp"
#include "slalom/vehicle/racing/corridor.hpp"
#include "slalom/vehicle/racing/minimum_time.hpp"
#include "slalom/vehicle/racing/racing_car.hpp"

namespace slalom::vehicle {

/// The start of a course, and the direction in which it is driven.
struct RaceCourseOptions {
  /// Start pose of the car, for closed courses. Without one, a course that is found in a map starts at the
  /// origin of the map frame if it passes there within 0.6 rad of +x; else it is driven counter-clockwise. A
  /// course without a start begins in the middle of its fastest part.
  std::optional<maps::Pose> start{};
  bool reverse = false;  ///< the other way round; not with a start
  double narrowest = 0;  ///< m, of the gaps through which a loop is searched; 0: as narrow as the car fits
};

/// A line to drive along, and whether it is closed.
struct GuideLine {
  std::vector<maps::Point> points{};  ///< m, map frame, in the direction of driving
  bool closed = true;                 ///< whether the first point follows the last one
  std::string note{};                 ///< points that were left out, and why; empty without any
};

/// A course made for a car.
struct RaceCourse {
  maps::OccupancyGrid map;         ///< the map
  Corridor corridor;               ///< the free space along the course
  Raceline raceline;               ///< the minimum-time line; begins beside the start
  std::vector<double> distance;    ///< m from each point of the raceline to the nearest wall
  maps::Pose start;                ///< pose of the car
  std::vector<std::string> notes;  ///< decisions, and things that were ignored, one sentence each
};

/// Makes a course from a map. Unknown cells are walls, but for spots that are no larger than the car is wide
/// and touch no occupied cell. Without `guide` it finds the way round an island of the map that is longest
/// for its width and passes the start; free space that reaches the border of the map counts as the
/// surroundings of the course. With `guide`, it drives along this line. Throws std::invalid_argument if there
/// is no such way, the start is not on it, or it is too narrow for the car; the message says where.
RaceCourse race_course(const maps::OccupancyGrid& map, const RacingCar& car,
                       const RaceCourseOptions& options = {}, const GuideLine* guide = nullptr);

/// Makes a course from a corridor, with a map that is drawn from it. Throws as race_course() of a map.
RaceCourse race_course(const Corridor& corridor, const RacingCar& car, const RaceCourseOptions& options = {});

/// m, the steps of a centre line that suit a car and a length (m).
double centre_line_step(const RacingCar& car, double length);

/// A map of a corridor, cells of `resolution` m: free between walls that are `wall` m thick, unknown beyond.
maps::OccupancyGrid draw_corridor(const Corridor& corridor, double resolution, double wall);

/// The point to which a line jumps, 0 if it does not: it is more than 20 usual (median) steps from the point
/// before, and the line turns by more than 1 rad at one of them, unlike a straight with only its ends.
std::size_t find_jump(std::span<const maps::Point> points);
/// A sentence without subject on the jump to a point.
std::string jump_text(std::span<const maps::Point> points, std::size_t jump);

/// The points and widths of a centre line file, and whether its ends meet.
struct CentreLineFile {
  GuideLine line;                   ///< the points, and whether the line is closed
  std::vector<double> left, right;  ///< m to the walls, a point each; empty if the file has only points
};

/// Reads a centre line: rows `x, y, width to the right, width to the left` (m), or x and y alone, separated
/// by commas or semicolons. Lines that begin with `#`, and a first row of names, are headers; if one names
/// the left width before the right one, that is their order. The line is closed if its ends are at most three
/// of its longest steps apart, or if it comes back to its start and follows itself from there to its end;
/// that part is left out. Throws IoError with file, line, column, value and rule, also where the line jumps.
CentreLineFile read_centre_line(const std::filesystem::path& file);

/// Writes a course folder, and creates it if it does not exist: map.yaml, map.png, raceline.csv (`# s_m; x_m;
/// ...`), centerline.csv (`# x_m, y_m, w_tr_right_m, w_tr_left_m`) and course.yaml. Throws IoError.
void save_race_course(const RaceCourse& course, const std::filesystem::path& folder, const TrackLabel& label);

}  // namespace slalom::vehicle
