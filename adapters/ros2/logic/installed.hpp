#pragma once

#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/course/course.hpp"

/// Courses and configurations that are installed with Slalom. They are searched in the first of these
/// prefixes that has courses: that of the node, those of the environment that a sourced ROS 2 sets, and that
/// of the Slalom that the package was built against.
namespace slalom::nodes {

/// Loads a course, given by its name or its folder. Throws IoError.
vehicle::Course load_course(const std::string& course);

/// Loads a configuration, given by its name or its file; empty means the defaults. Throws IoError.
vehicle::Configuration load_configuration(const std::string& configuration);

}  // namespace slalom::nodes
