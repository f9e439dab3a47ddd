#pragma once

#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"

namespace slalom::vehicle {

/// The car against which a course is checked.
struct CourseCheckOptions {
  double half_width = 0.155;  ///< m, of the body
  double margin = 0;          ///< m, that the body keeps from walls
  SpeedLimits limits;         ///< limits of tyres, motor and brakes
};

/// A part of a course where it breaks a rule. Parts with a gap of less than 1 m between them count as one.
struct CourseStretch {
  double begin = 0, end = 0;  ///< m along the waypoints
  maps::Point worst;          ///< the place where the rule is broken most, map frame
  double value = 0;           ///< there
};

/// The parts of a course that break one rule.
struct CourseFinding {
  double share = 0;                      ///< share of the length, 0 .. 1
  std::vector<CourseStretch> stretches;  ///< stretches in the order of the course
};

/// The findings about a course.
struct CourseCheck {
  CourseFinding walls;  ///< nearer to a wall than half the width and the margin; value: m from line to wall
  CourseFinding grip;   ///< asks for more than the limits; value: the acceleration asked for, m/s^2
  /// m, smallest distance from the line to a wall, at most half the width plus the margin
  double min_distance = 0;
  double max_acceleration = 0;  ///< m/s^2, the most that the profile asks for, along and across together
};

/// Compares the line of a course with its walls, and its profile with the limits of a car: the lateral
/// acceleration v^2 k and the acceleration along the line, v dv/ds, must be inside an ellipse with the
/// limits as half axes. Occupied cells are walls.
CourseCheck check_course(const Course& course, const CourseCheckOptions& options);

/// The findings in words, one sentence for each broken rule, with its share and its three worst places.
std::vector<std::string> sentences(const CourseCheck& check, const CourseCheckOptions& options);

/// Lowers the speeds of a course to the limits (see feasible_speeds).
void make_feasible(Course& course, const SpeedLimits& limits);
/// Makes a path feasible; it is closed if its ends are near each other (see path_geometry).
void make_feasible(std::vector<maps::ReferencePoint>& path, const SpeedLimits& limits);

}  // namespace slalom::vehicle
