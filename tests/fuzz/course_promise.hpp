#pragma once

#include <cmath>
#include <filesystem>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "slalom/vehicle/course/course_check.hpp"

namespace slalom::fuzz {

/// Loads a course: false if that throws IoError; otherwise it can be driven and checked.
inline bool check_course_of(const std::filesystem::path& folder) {
  try {
    const vehicle::Course course = vehicle::load_course(folder);
    require(course.waypoints.size() >= 3, "a course has three waypoints");
    for (const vehicle::Waypoint& at : course.waypoints)
      require(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.yaw) && at.speed >= 0 &&
                  std::isfinite(at.speed) && std::isfinite(at.arc_length),
              "waypoints are finite");
    require(course.length > 0 && std::isfinite(course.length),
            "the length of a course is finite and above 0");
    require(std::isfinite(course.start.x) && std::isfinite(course.start.y) && std::isfinite(course.start.yaw),
            "the start is finite");
    require(!course.obstacle_path.empty(), "obstacles have places");
    const vehicle::CourseCheck check = vehicle::check_course(course, {});
    for (const vehicle::CourseFinding& finding : {check.walls, check.grip})
      require(finding.share >= 0 && finding.share <= 1 + 1e-9, "a share is within 0 and 1");
    return true;
  } catch (const IoError&) {
    return false;
  }
}

}  // namespace slalom::fuzz
