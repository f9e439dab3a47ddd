#pragma once

#include <filesystem>

#include "slalom/core/option_access.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/vehicle/model/vehicle_options.hpp"
#include "slalom/vehicle/planner/planner_options.hpp"

/// All options of a driver: those of every method, of the vehicle model and of the planner. Configuration
/// files, command line and listings are derived from their declarations.
namespace slalom::vehicle {

/// The sections of a configuration. An option that a file does not set has the default of its aggregate.
struct Configuration {
  // The methods come first: with a member before them, g++ 12 reports its list as maybe uninitialised
  // wherever a temporary is made and every_method() could throw.
  std::vector<SolverOptions> methods = every_method();  ///< one of each, in the order of solver_names()
  VehicleOptions vehicle;                               ///< options of the car model and its costs
  PlannerOptions planner;                               ///< options of the planner

  /// The default options of every method, in the order of solver_names().
  static std::vector<SolverOptions> every_method();
};

/// Calls `visit(name, options)` for every section.
template <class AnyConfiguration, class Visit>
requires is_options_of<AnyConfiguration, Configuration>
void visit_sections(AnyConfiguration& configuration, Visit&& visit) {
  visit("vehicle", configuration.vehicle);
  visit("planner", configuration.planner);
  for (auto& method : configuration.methods) visit(method.method(), method);
}

/// Reads a configuration file: YAML with a map of options for each section,
///
///     base: default              # optional: another configuration to start from
///     svg_mppi:
///       samples: 4000
///       variance: 0.1            # a list of one value per input, [0.1], says the same
///     planner:
///       max_speed: 6
///
/// `base` is a file beside this one, or a configuration that is found by its name in `roots`. Throws IoError
/// with file, line, key, value and rule for a key that is unknown or duplicate, a value of the wrong type or
/// out of range, keys that contradict each other, and a second document.
Configuration load_configuration(const std::filesystem::path& file,
                                 const std::vector<std::filesystem::path>& roots = {});

/// The folders in which configurations are searched by name: SLALOM_CONFIGS_DIR if set, then, relative to the
/// folder of the running program, the `configs` of the source tree it was built in and the install's
/// share/slalom/configs. Only those that exist.
std::vector<std::filesystem::path> configuration_roots(const std::filesystem::path& program_folder);

/// The file of a configuration: `name_or_file` itself if it is a file, else the first
/// `root/name_or_file.yaml`. Throws IoError that names the folders searched and the configurations found.
std::filesystem::path find_configuration(const std::string& name_or_file,
                                         const std::vector<std::filesystem::path>& roots);

/// Sets `section.option` from text; a key without a section is an option of `default_section`. Throws
/// std::invalid_argument that names key, value and rule, and the nearest known key.
void set_option(Configuration& configuration, std::string_view key, std::string_view text,
                std::string_view default_section = {});

/// One section with all its options.
struct Section {
  std::string name;                  ///< the name
  std::vector<OptionEntry> options;  ///< options with their present values
};
/// All options by section.
std::vector<Section> list_sections(const Configuration& configuration);

/// The solver of a method for the configuration's vehicle model, with `threads` threads; the method's own
/// `threads` is ignored. Throws std::invalid_argument on an unknown method and on options out of range.
std::unique_ptr<Solver> make_solver(const Configuration& configuration, std::string_view method, int threads);

/// The whole configuration as YAML, from which load_configuration restores it.
std::string to_yaml(const Configuration& configuration);

}  // namespace slalom::vehicle
