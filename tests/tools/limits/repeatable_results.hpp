#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/evaluation_folder.hpp"

/// Runs of the program that are repeated while the system gives it less.
namespace slalom::testing {

/// Removes what differs between runs of the same command: times of the wall clock, in ms, the machine, and
/// the build, which a preloaded library changes, with the checksums of files that hold it.
inline void remove_conditions(nlohmann::json& json) {
  const auto differs = [](const std::string& key) {
    return contains(key, "_ms") || key == "machine" || key == "build" || key == "checksum";
  };
  if (json.is_object()) {
    for (auto each = json.begin(); each != json.end();)
      each = differs(each.key()) ? json.erase(each) : std::next(each);
  }
  if (json.is_structured())
    for (auto& each : json) remove_conditions(each);
}

/// The files in `folder` and below by their names, without what differs between runs.
inline std::map<std::string, std::string> repeatable_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const fs::path& file = entry.path();
    std::string text = file.filename() == "laps.csv" ? repeatable(file) : content(file);
    if (file.extension() == ".json") {
      auto json = nlohmann::json::parse(text);
      remove_conditions(json);
      text = json.dump();
    }
    files[fs::relative(file, folder).string()] = text;
  }
  return files;
}

/// Expects the same files, and names those that differ.
inline void expect_same_files(const fs::path& folder, const std::map<std::string, std::string>& expected,
                              const std::string& what) {
  const auto files = repeatable_files(folder);
  for (const auto& [name, text] : expected) {
    const auto found = files.find(name);
    ASSERT_NE(found, files.end()) << what << ": " << name << " is missing";
    EXPECT_TRUE(found->second == text) << what << ": " << name << " differs";
  }
  EXPECT_EQ(files.size(), expected.size()) << what;
}

}  // namespace slalom::testing
