#include <algorithm>
#include <cstdlib>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "vehicle/course/course_yaml.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr const char* known_file = "known.yaml";

}  // namespace

std::vector<fs::path> course_roots(const fs::path& program_folder) {
  std::vector<fs::path> candidates;
  if (const char* chosen = std::getenv("SLALOM_COURSES_DIR"); chosen && *chosen)
    candidates.emplace_back(chosen);
  const fs::path program = fs::weakly_canonical(program_folder);
  fs::path above = program;
  // build/<preset>/bin is three folders below the source tree; other build folders may be
  // higher or lower.
  for (int level = 0; level < 5 && above.has_parent_path(); ++level, above = above.parent_path())
    if (fs::exists(above / "courses" / known_file)) candidates.push_back(above / "courses");
  candidates.push_back(program.parent_path() / "share" / "slalom" / "courses");
  std::vector<fs::path> roots;
  for (const auto& candidate : candidates)
    if (fs::is_directory(candidate)) roots.push_back(candidate);
  return roots;
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
  if (fs::is_directory(name_or_folder)) return name_or_folder;
  for (const auto& root : roots)
    if (fs::is_directory(root / name_or_folder)) return root / name_or_folder;
  std::string known, searched;
  for (const auto& name : course_names(roots)) known += (known.empty() ? "" : ", ") + name;
  for (const auto& root : roots) searched += (searched.empty() ? "" : ", ") + root.string();
  throw IoError(name_or_folder, 0,
                "is neither a folder nor the name of a course (known: " + (known.empty() ? "none" : known) +
                    "; searched: " + (searched.empty() ? "nowhere" : searched) + ")");
}

std::optional<KnownCourse> known_course(const std::string& name, const std::vector<fs::path>& roots) {
  for (const auto& root : roots)
    if (const fs::path file = root / known_file; fs::exists(file))
      return detail::read_known_course(file, name);
  return std::nullopt;
}

}  // namespace slalom::vehicle
