#include <algorithm>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "vehicle/yaml_file.hpp"

namespace slalom::vehicle {
namespace fs = std::filesystem;

std::vector<fs::path> course_roots(const fs::path& program_folder) {
  return detail::known_folders(program_folder, "courses", "known.yaml", "SLALOM_COURSES_DIR");
}

std::vector<std::string> course_names(const std::vector<fs::path>& roots) {
  std::vector<std::string> names;
  for (const auto& root : roots) {
    if (!fs::is_directory(root)) continue;
    for (const fs::path& entry : list_folder(root))
      if (fs::is_directory(entry)) names.push_back(entry.filename().string());
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

fs::path find_course(const std::string& name_or_folder, const std::vector<fs::path>& roots) {
  if (name_or_folder.empty())
    throw IoError("course", 0, "is empty; must be a folder or the name of a course");
  if (std::error_code none; fs::is_directory(name_or_folder, none)) return name_or_folder;
  for (const auto& root : roots)
    if (std::error_code none; fs::is_directory(root / name_or_folder, none)) return root / name_or_folder;
  throw IoError(
      name_or_folder, 0,
      "is neither a folder nor the name of a course (known: " + detail::listed(course_names(roots), "none") +
          "; searched: " + detail::listed(roots) + ")");
}

}  // namespace slalom::vehicle
