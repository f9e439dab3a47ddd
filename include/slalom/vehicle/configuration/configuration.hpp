#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "slalom/core/option_access.hpp"
#include "slalom/solvers/make_solver.hpp"
#include "slalom/vehicle/model/path_tracking.hpp"
#include "slalom/vehicle/planner/planner.hpp"

/// Everything that can be set of a driver: the options of every method, of the vehicle problem and of the
/// planner, each an aggregate of its own, from which files, command line and listings are derived.
namespace slalom::vehicle {

/// The sections of a configuration. What a file does not say keeps the defaults of the aggregates.
struct Configuration {
  PathTrackingOptions vehicle;
  PlannerOptions planner;
  std::vector<SolverOptions> methods = every_method();  ///< one of each, in the order of solver_names()

  static std::vector<SolverOptions> every_method();
};

/// Calls `visit(name, options)` for every section.
template <class AnyConfiguration, class Visit>
requires is_options_of<AnyConfiguration, Configuration>
void visit_sections(AnyConfiguration& configuration, Visit&& visit) {
  visit("vehicle", configuration.vehicle);
  visit("planner", configuration.planner);
  for (auto& method : configuration.methods)
    std::visit([&](auto& options) { visit(solver_name(method), options); }, method);
}

/// Reads a configuration file: YAML with a map of options for each section,
///
///     base: published            # optional: another configuration to start from
///     svg_mppi:
///       samples: 4000
///       variance: 0.1            # a list of one value per input, [0.1], says the same
///     vehicle:
///       max_speed: 6             # another name of planner.max_speed
///
/// Throws IoError with file, line, key, value and rule for everything that is not known, not of its type, out
/// of range, said twice or at odds with another key of the file, and for a second document.
Configuration load_configuration(const std::filesystem::path& file,
                                 const std::vector<std::filesystem::path>& roots = {});

/// The folders in which configurations are looked for by name: SLALOM_CONFIGS_DIR if set, then, seen from the
/// folder of the running program, the source tree it was built in and the install's share/slalom/configs.
/// Only those that exist.
std::vector<std::filesystem::path> configuration_roots(const std::filesystem::path& program_folder);

/// The file of a configuration: `name_or_file` itself if it is a file, else the first
/// `root/name_or_file.yaml`. Throws IoError that names the places searched and the configurations known.
std::filesystem::path find_configuration(const std::string& name_or_file,
                                         const std::vector<std::filesystem::path>& roots);

/// Sets `section.option` from text; a key without a section means an option of `default_section`. Throws
/// std::invalid_argument naming key, value and rule, with the nearest known key.
void set_option(Configuration& configuration, std::string_view key, std::string_view text,
                std::string_view default_section = {});

/// One section with all its options as they are set.
struct Section {
  std::string name;
  std::vector<OptionEntry> options;
};
std::vector<Section> list_sections(const Configuration& configuration);

/// The solver of a method, for the vehicle problem, with `threads` threads whatever the configuration says.
/// Throws std::invalid_argument on an unknown method and on options out of range.
std::unique_ptr<Solver> make_solver(const Configuration& configuration, std::string_view method, int threads);

/// The whole configuration as a file that load_configuration reads back to the same.
std::string to_yaml(const Configuration& configuration);

}  // namespace slalom::vehicle
