#include "tools/scenario/scenario.hpp"

#include <charconv>
#include <system_error>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/core/version.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/vehicle/course/course_check.hpp"
#include "tools/command_line/command.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

/// A value as JSON; numbers that are not finite as text, and a list of one number as that number.
Json value_json(const OptionValue& value) {
  const auto number = [](double each) { return std::isfinite(each) ? Json(each) : Json(to_text(each)); };
  if (const auto* one = std::get_if<double>(&value)) return number(*one);
  if (const auto* several = std::get_if<std::vector<double>>(&value)) {
    if (several->size() == 1) return number(several->front());
    Json list = Json::array();
    for (const double each : *several) list.push_back(number(each));
    return list;
  }
  return std::visit([](const auto& each) { return Json(each); }, value);
}

/// Lists the gaps in the course's files, and the places where its line and profile ask too much of the car.
std::vector<std::string> notes_on(const evaluation::Environment& environment,
                                  const vehicle::Configuration& configuration) {
  const vehicle::Course& course = environment.course;
  std::vector<std::string> notes = course.notes;
  if (environment.start_moved > 0)
    notes.push_back("a car at the first waypoint would be in a wall; laps start " +
                    to_text(std::round(10 * environment.start_moved) / 10) + " m further along the line");
  const vehicle::PlannerOptions& planner = configuration.planner;
  const vehicle::PathTrackingOptions& car = configuration.vehicle;
  const bool lowered = planner.profile_friction > 0;
  const auto& tyres = configuration.vehicle.own_of<vehicle::SingleTrackOptions>();
  const double friction = lowered ? planner.profile_friction : tyres.friction * tyres.usable_grip;
  vehicle::CourseCheckOptions options;
  options.half_width = car.body.width / 2;
  options.margin = car.body.margin;
  options.limits =
      vehicle::grip_limits(friction, planner.max_speed, car.max_acceleration, car.max_deceleration);
  const vehicle::CourseCheck check = vehicle::check_course(course, options);
  for (std::string& sentence : sentences(check, options)) notes.push_back(std::move(sentence));
  if (check.grip.stretches.empty()) return notes;
  if (lowered)
    notes.push_back("planner.profile_friction lowers the profile to what the car can");
  else if (vehicle::make_vehicle_model(configuration.vehicle)->traits().tyres.friction > 0)
    notes.push_back("the planner lowers the profile to what the car can");
  else
    notes.push_back("--set planner.profile_friction=" + to_text(friction) +
                    " lowers the profile to what the car can");
  return notes;
}

/// Every --set: of the configuration, or of the world.
void apply_settings(const std::vector<std::string>& assignments, const std::string& method,
                    vehicle::Configuration& configuration, evaluation::LapSettings& lap) {
  for (const std::string& assignment : assignments) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0)
      throw CommandLineError("--set", assignment, "must be key=value");
    apply_setting(assignment.substr(0, equals), assignment.substr(equals + 1), method, configuration, lap);
  }
}

/// The configuration as its file has it; `option` names it on the command line.
vehicle::Configuration file_configuration(const std::string& config, const char* option) {
  const auto roots = vehicle::configuration_roots(program_folder());
  const fs::path file = for_option(option, [&] { return vehicle::find_configuration(config, roots); });
  return vehicle::load_configuration(file, roots);
}

}  // namespace

void apply_setting(const std::string& key, const std::string& value, const std::string& method,
                   vehicle::Configuration& configuration, evaluation::LapSettings& lap) {
  for_option("--set", [&] {
    if (!evaluation::set_world_option(lap, key, value))
      vehicle::set_option(configuration, key, value, method);
  });
}

vehicle::RacingCar find_racing_car(const std::string& name) {
  const auto names = vehicle::racing_car_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return vehicle::racing_car(name);
  vehicle::RacingCar car = vehicle::racing_car(file_configuration(name, "--car"));
  car.name = fs::path(name).stem().string();
  return car;
}

maps::Pose parse_pose(const char* option, const std::string& text) {
  std::array<double, 3> values{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [stopped, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 < values.size() ? stopped < end && *stopped == ',' : stopped == end;
    if (error != std::errc{} || !separated)
      throw CommandLineError(option, text, "must be x,y,yaw: three numbers, in m, m, rad");
    at = stopped + 1;
  }
  const maps::Pose pose{values[0], values[1], values[2]};
  if (!maps::is_plausible(pose)) throw CommandLineError(option, text, maps::PoseLimits::rule);
  return pose;
}

fs::path program_folder() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  return failed ? fs::current_path() : program.parent_path();
}

void add_world_options(Subcommand& command, ScenarioArguments& a) {
  command.option("--course", a.course, "Course name or folder");
  command.option("--config", a.config, config_help);
  command.option(
      "--evaluation", a.evaluation,
      "true: physically correct world; published: world, clock and counting of the paper's program");
  command.option("--latency-ms", a.latency_ms,
                 "Delay from a scan to the effect of its command, ms; only with --evaluation true",
                 {0, 1000});
  command.flag(
      "--hardware", a.hardware,
      "Conditions of a real car: sensor noise, slip, localisation, a servo that differs from the model");
}

void add_scenario_options(Subcommand& command, ScenarioArguments& a) {
  add_world_options(command, a);
  command.option(
      "--set", a.set,
      "section.option=value, or option=value for the method's own; may be repeated (slalom options "
      "lists them)");
  command.option("--obstacles", a.obstacles, "Number of parked cars on the course", {0, 1000});
  command.option(
      "--obstacle", a.obstacle,
      "Place x,y,yaw of a parked car, m, m, rad; may be repeated; --obstacles adds others at random");
  command.option(
      "--opponents", a.opponents,
      "Number of cars that drive along the course line at half its speed; only with --evaluation true",
      {0, 16});
  command.option("--start", a.start,
                 "Start pose x,y,yaw of the car's centre of gravity, m, m, rad [start of the course]");
  command.option("--threads", a.threads, "Number of solver threads; results do not depend on it", {1, 1024});
}

std::string method_names() {
  std::string names;
  for (const char* name : solver_names()) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

void add_method_option(Subcommand& command, std::string& method) {
  command.option("--method", method, "One of " + method_names());
}

vehicle::Configuration load_configuration(const ScenarioArguments& arguments, const std::string& method) {
  for_option("--method", [&] { return solver_options(method); });
  vehicle::Configuration configuration = file_configuration(arguments.config, "--config");
  evaluation::LapSettings world;
  apply_settings(arguments.set, method, configuration, world);
  return configuration;
}

Scenario load_scenario(const ScenarioArguments& arguments, const std::string& method) {
  Scenario scenario;
  const auto evaluation =
      for_option("--evaluation", [&] { return evaluation::protocol_named(arguments.evaluation); });
  scenario.configuration = load_configuration(arguments, method);
  const auto roots = vehicle::course_roots(program_folder());
  scenario.folder = for_option("--course", [&] { return vehicle::find_course(arguments.course, roots); });
  scenario.environment = evaluation::load_environment(scenario.folder, evaluation, roots);
  const maps::Point& origin = scenario.environment->course.origin;
  for (const std::string& place : arguments.obstacle) {
    const maps::Pose pose = parse_pose("--obstacle", place);
    scenario.lap.parked.push_back({pose.x - origin.x, pose.y - origin.y, pose.yaw});
  }
  scenario.lap.obstacles = std::max(arguments.obstacles, static_cast<int>(arguments.obstacle.size()));
  scenario.lap.opponents = arguments.opponents;
  scenario.lap.latency = 1e-3 * arguments.latency_ms;
  if (arguments.hardware) scenario.lap.hardware.emplace();
  scenario.lap.threads = arguments.threads;
  scenario.lap.saturating_tyres = arguments.saturating_tyres;
  apply_settings(arguments.set, method, scenario.configuration, scenario.lap);
  const auto sets_friction = [](const std::string& each) { return each.starts_with("world.friction="); };
  if (scenario.lap.car == evaluation::CarKind::configured &&
      std::none_of(arguments.set.begin(), arguments.set.end(), sets_friction))
    scenario.lap.friction = scenario.configuration.vehicle.own_of<vehicle::SingleTrackOptions>().friction;
  if (scenario.lap.planning_opponents > 0)
    scenario.lap.opponent_planner = std::make_shared<const evaluation::Driver>(
        evaluation::Driver{file_configuration(arguments.config, "--config")});
  if (!arguments.start.empty()) {
    const maps::Pose start = parse_pose("--start", arguments.start);
    scenario.lap.start = maps::Pose{start.x - origin.x, start.y - origin.y, start.yaw};
  }
  scenario.notes = notes_on(*scenario.environment, scenario.configuration);
  return scenario;
}

void add_conditions(Json& settings, const ScenarioArguments& arguments, const Scenario& scenario) {
  if (arguments.hardware) settings["hardware"] = true;
  for (const fs::path& root : vehicle::course_roots(program_folder()))
    if (std::error_code failed; fs::equivalent(scenario.folder.parent_path(), root, failed)) return;
  settings["course_folder"] = fs::weakly_canonical(scenario.folder).string();
}

maps::OccupancyGrid map_of(const Scenario& scenario) {
  vehicle::Course course = vehicle::load_course(scenario.folder);
  vehicle::move_to_local_origin(course);
  return course.map;
}

void print_notes(std::FILE* out, const Scenario& scenario) {
  for (const std::string& note : scenario.notes)
    std::fprintf(out, "note: %s: %s\n", scenario.environment->course.name.c_str(), note.c_str());
}

Json options_json(const vehicle::Configuration& configuration, const std::string& method) {
  Json options;
  for (const auto& section : vehicle::list_sections(configuration)) {
    if (section.name != "vehicle" && section.name != "planner" && section.name != method) continue;
    for (const OptionEntry& entry : section.options) {
      const std::string key = entry.declaration.name;
      // A lap's seed and the program's threads take their place.
      if (section.name == method && (key == "seed" || key == "threads")) continue;
      options[section.name][key] = value_json(entry.value);
    }
  }
  return options;
}

Json settings_json(const ScenarioArguments& arguments, const Scenario& scenario, const std::string& method) {
  const maps::Pose start = scenario.lap.start.value_or(scenario.environment->start);
  const maps::Point& origin = scenario.environment->course.origin;
  Json settings{{"course", scenario.environment->course.name},
                {"method", method},
                {"config", arguments.config},
                {"evaluation", arguments.evaluation},
                {"obstacles", scenario.lap.obstacles},
                {"opponents", arguments.opponents},
                {"start", {start.x + origin.x, start.y + origin.y, start.yaw}},
                {"latency_ms", arguments.latency_ms},
                {"options", options_json(scenario.configuration, method)}};
  for (const OptionEntry& entry : list_options(scenario.lap))
    settings["options"]["world"][entry.declaration.name] = value_json(entry.value);
  if (const auto& driver = scenario.lap.opponent_planner)
    settings["opponent_planner"] = {{"method", driver->method},
                                    {"options", options_json(driver->configuration, driver->method)}};
  if (origin.x != 0 || origin.y != 0) settings["origin"] = {origin.x, origin.y};
  for (const maps::Pose& place : scenario.lap.parked)
    settings["obstacle_places"].push_back({place.x + origin.x, place.y + origin.y, place.yaw});
  add_conditions(settings, arguments, scenario);
  return settings;
}

Json results_json(const Json& settings, const Scenario& scenario) {
  Json results{{"program", std::string("slalom ") + version()}, {"settings", settings}};
  results["settings"]["threads"] = scenario.lap.threads;
  return results;
}

}  // namespace slalom::tools
