#pragma once

#include <string>
#include <vector>

namespace slalom::nodes {

/// A key of a section, and its fate in the import.
struct ImportedKey {
  enum class Fate { taken, changed, dropped, unknown };
  int line = 0;       ///< from 1, of the key
  std::string key;    ///< below the section, with dots between sections
  std::string value;  ///< value in the file; only a description if it is a list or a map
  Fate fate = Fate::taken;
  std::string result;  ///< name and value here, where it was changed
  std::string why;     ///< in a few words, unless it was taken
};
/// The name of a fate, for reports.
const char* name(ImportedKey::Fate fate);

/// The section of a controller, such as FollowPath.
struct ImportedSection {
  std::string name;
  int line = 0;      ///< from 1, of its name
  std::string yaml;  ///< section for slalom_nav2::Controller
  std::vector<ImportedKey> keys;
};

/// The sections of nav2's MPPI controller (nav2_mppi_controller::MPPIController, nav2 1.3) in a parameter
/// file, for slalom_nav2::Controller. Throws std::exception that names file, line, key, value and rule if the
/// file is not YAML, it has no such section, or a value that would be taken breaks a rule.
std::vector<ImportedSection> import_mppi(const std::string& file);

}  // namespace slalom::nodes
