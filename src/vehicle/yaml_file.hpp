#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace slalom::vehicle::detail {

/// The one document of a file. Throws IoError if it cannot be read, is not YAML as
/// maps::yaml_text takes it, or has a duplicate key.
YAML::Node load_yaml(const std::filesystem::path& file);

/// Throws the IoError which says that the value `at` of `key` breaks `rule`.
[[noreturn]] void throw_at(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
                           const std::string& rule);

/// The folders in which courses or configurations are searched by name: that of an environment variable if it
/// is set; relative to the folder of the running program, a folder of this name with the file `marker`, in
/// that folder or up to four above it; and the install's share/slalom/NAME. Only those that exist.
inline std::vector<std::filesystem::path> known_folders(const std::filesystem::path& program_folder,
                                                        const char* name, const char* marker,
                                                        const char* variable) {
  std::vector<std::filesystem::path> candidates;
  if (const char* chosen = std::getenv(variable); chosen && *chosen) candidates.emplace_back(chosen);
  const std::filesystem::path program = std::filesystem::weakly_canonical(program_folder);
  std::filesystem::path above = program;
  for (int level = 0; level < 5 && above.has_parent_path(); ++level, above = above.parent_path())
    if (std::filesystem::exists(above / name / marker)) candidates.push_back(above / name);
  candidates.push_back(program.parent_path() / "share" / "slalom" / name);
  std::erase_if(candidates,
                [](const std::filesystem::path& each) { return !std::filesystem::is_directory(each); });
  return candidates;
}

/// "a, b, c", or `otherwise` where there is nothing.
inline std::string listed(const std::vector<std::string>& names, const char* otherwise) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? otherwise : all;
}

/// The same of folders.
inline std::string listed(const std::vector<std::filesystem::path>& folders) {
  return listed(std::vector<std::string>(folders.begin(), folders.end()), "nowhere");
}

}  // namespace slalom::vehicle::detail
