#include "logic/installed.hpp"

#include <cstdlib>
#include <sstream>

namespace slalom::nodes {
namespace {

/// Returns the folder from which courses and configurations are searched: `bin` of a prefix, or the folder of
/// the node where no prefix has courses.
std::filesystem::path program_folder() {
  const auto own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::filesystem::path> prefixes{own.parent_path().parent_path()};
  for (const char* variable : {"AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"}) {
    const char* const value = std::getenv(variable);
    std::istringstream folders(value ? value : "");
    for (std::string folder; std::getline(folders, folder, ':');) prefixes.emplace_back(folder);
  }
#ifdef SLALOM_INSTALL_PREFIX
  prefixes.emplace_back(SLALOM_INSTALL_PREFIX);
#endif
  for (const auto& prefix : prefixes)
    if (std::filesystem::exists(prefix / "share" / "slalom" / "courses")) return prefix / "bin";
  return own;
}

}  // namespace

vehicle::Course load_course(const std::string& course) {
  return vehicle::load_course(vehicle::find_course(course, vehicle::course_roots(program_folder())));
}

vehicle::Configuration load_configuration(const std::string& configuration) {
  if (configuration.empty()) return {};
  const auto roots = vehicle::configuration_roots(program_folder());
  return vehicle::load_configuration(vehicle::find_configuration(configuration, roots), roots);
}

}  // namespace slalom::nodes
