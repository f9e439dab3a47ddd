#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

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
