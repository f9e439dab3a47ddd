#pragma once

#include <string>

namespace slalom::nodes {

/// The sections of nav2's MPPI controller in a parameter file, imported.
struct MppiImport {
  std::string yaml;  ///< the same sections for slalom_nav2::Controller
  std::string
      report;  ///< a line for each key: file, line, key, value, and taken, changed, dropped or unknown
};

/// Imports the sections of nav2_mppi_controller::MPPIController (nav2 1.3) in a parameter file. Throws
/// std::exception that names file, line, key, value and rule if the file is not YAML, it has no such section,
/// or a value that would be taken breaks a rule.
MppiImport import_mppi(const std::string& file);

}  // namespace slalom::nodes
