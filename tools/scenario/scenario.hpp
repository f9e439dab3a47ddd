#pragma once

#include <cstdio>
#include <nlohmann/json_fwd.hpp>

#include "slalom/evaluation/environment.hpp"
#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/racing/racing_car.hpp"
#include "tools/command_line/command.hpp"

/// The options shared by all commands that drive: course, configuration, evaluation, method.
namespace slalom::tools {

/// Help of --config.
inline constexpr const char* config_help =
    "Configuration: default, race, race_obstacles, racing_benchmark, default_kinematic, default_speed, "
    "passenger_car, published, paper, hardware, or a file";

/// The folder of the running program.
std::filesystem::path program_folder();

/// Help of --car.
inline constexpr const char* car_help = "Car: f1tenth, passenger, or a configuration (name or file)";

/// The car of a course: one of racing_car_names(), or a configuration's. Throws CommandLineError, IoError.
vehicle::RacingCar find_racing_car(const std::string& name);

/// The pose `x,y,yaw` (m, m, rad) of an option. Throws CommandLineError.
maps::Pose parse_pose(const char* option, const std::string& text);

struct ScenarioArguments {
  std::string course = "fox";
  std::string config = "default";
  std::string evaluation = "true";
  std::vector<std::string> set{};       ///< key=value, in order
  std::string start{};                  ///< x,y,yaw or empty
  int obstacles = 0;                    ///< at least as many as places are given
  std::vector<std::string> obstacle{};  ///< places x,y,yaw of the first of them
  int opponents = 0;
  double latency_ms = 0;
  bool hardware = false;          ///< the conditions of a real car
  bool saturating_tyres = false;  ///< tyres of the world, unless `set` has world.saturating_tyres
  int threads = 1;
};

/// Adds --course, --config, --evaluation, --latency-ms and --hardware.
void add_world_options(Subcommand& command, ScenarioArguments& arguments);
/// Adds the options of add_world_options, and --set, --start, --obstacles, --opponents and --threads.
void add_scenario_options(Subcommand& command, ScenarioArguments& arguments);
/// The names of all methods, separated by ", ".
std::string method_names();
/// Adds --method to `method`, with the names known.
void add_method_option(Subcommand& command, std::string& method);

struct Scenario {
  std::filesystem::path folder;  ///< folder of the course
  std::shared_ptr<const evaluation::Environment> environment;
  vehicle::Configuration configuration;
  evaluation::LapSettings lap;
  std::vector<std::string> notes;  ///< about the course, one sentence each: what its files and its line lack
};

/// Adds `hardware` if it is asked for, and `course_folder`, so that a replay finds the course again: the
/// absolute folder of a course that is in none of the folders where courses are searched by name.
void add_conditions(nlohmann::ordered_json& settings, const ScenarioArguments& arguments,
                    const Scenario& scenario);

/// The map of the course for a picture, in the frame of the environment. Cells that the published evaluation
/// treats as free are unknown, as in the file. Throws IoError.
maps::OccupancyGrid map_of(const Scenario& scenario);

/// Prints the notes, one a line.
void print_notes(std::FILE* out, const Scenario& scenario);

/// One --set, of the configuration or of the world. Throws IoError, with --set as the file.
void apply_setting(const std::string& key, const std::string& value, const std::string& method,
                   vehicle::Configuration& configuration, evaluation::LapSettings& lap);

/// The configuration alone: the file, then every --set; a key without a section is one of `method`. Throws
/// IoError, which for --set names it as the file.
vehicle::Configuration load_configuration(const ScenarioArguments& arguments, const std::string& method);

/// Everything loaded and checked. Throws IoError, std::invalid_argument.
Scenario load_scenario(const ScenarioArguments& arguments, const std::string& method);

/// Every option as it is set: {section: {option: value}}; infinite values as text.
nlohmann::ordered_json options_json(const vehicle::Configuration& configuration, const std::string& method);

/// The settings that go with a result: course, evaluation, method, obstacles, start, options ...
nlohmann::ordered_json settings_json(const ScenarioArguments& arguments, const Scenario& scenario,
                                     const std::string& method);

/// The beginning of a file of results: the program, and the settings with the number of threads.
nlohmann::ordered_json results_json(const nlohmann::ordered_json& settings, const Scenario& scenario);

}  // namespace slalom::tools
