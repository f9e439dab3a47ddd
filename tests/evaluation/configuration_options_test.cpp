// Every option of svg_mppi that a configuration sets changes what it drives.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>

#include "slalom/core/option_access.hpp"
#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::evaluation {
namespace {

const std::string method = "svg_mppi";

/// Options that change nothing in a configuration. A row that is no longer true fails. With one guide, as of
/// few samples, there are no others; the variance is adapted; q* of `paper` has the temperature of samples;
/// `race` reaches no lower bound in this second.
const std::map<std::string, std::set<std::string>> inert = {
    {"paper", {"restart_guides", "fit_all_guides", "variance", "fit_temperature"}},
    {"published", {"restart_guides", "fit_all_guides", "variance"}},
    {"hardware", {"restart_guides", "fit_all_guides", "variance"}},
    {"default_kinematic", {"variance"}},
    {"default_speed", {"variance"}},
    {"race", {"input_min"}}};

/// Options that act only where a guide leaves its bounds, all its samples are bad, or a limit is reached.
const std::set<std::string> seldom = {"clamp_guides", "subtract_minimum", "gradient_floor", "variance_min",
                                      "normaliser_offset"};

/// The names of the options of the method that a configuration or its bases set.
std::set<std::string> options_set(const std::string& name) {
  std::set<std::string> options;
  std::ifstream file(SLALOM_CONFIGS "/" + name + ".yaml");
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("base: ", 0) == 0) options.merge(options_set(line.substr(6)));
    if (!line.empty() && line[0] != ' ' && line[0] != '#') inside = line == method + ":";
    if (inside && line.rfind("  ", 0) == 0) options.insert(line.substr(2, line.find(':') - 2));
  }
  return options;
}

/// Another value of an option, which its range allows.
std::string changed(const OptionEntry& entry) {
  OptionValue value = entry.value;
  if (auto* flag = std::get_if<bool>(&value)) *flag = !*flag;
  if (auto* count = std::get_if<int>(&value)) *count += 1;
  if (auto* number = std::get_if<double>(&value)) *number = *number == 0 ? 0.1 : 0.7 * *number;
  if (auto* numbers = std::get_if<std::vector<double>>(&value))
    for (double& number : *numbers) number *= 0.7;
  if (auto* choice = std::get_if<std::string>(&value))
    *choice = entry.choices[*choice == entry.choices[0] ? 1 : 0];
  return to_text(value);
}

/// The commands of a second among parked cars.
std::vector<double> drive(const vehicle::Configuration& configuration) {
  static const auto environment = load_environment(SLALOM_COURSES "/wren", Protocol::true_physics, {});
  LapDrive drive({environment, {configuration, method}, {.obstacles = 5}}, 4);
  std::vector<double> commands;
  for (int step = 0; step < 25; ++step)
    drive.step([&](const ControlStep& tick) {
      commands.push_back(tick.output.command.steer);
      commands.push_back(tick.output.command.speed);
    });
  return commands;
}

class ConfigurationOptions : public ::testing::TestWithParam<const char*> {};

TEST_P(ConfigurationOptions, ActOnTheDrive) {
  vehicle::Configuration configuration =
      vehicle::load_configuration(SLALOM_CONFIGS "/" + std::string(GetParam()) + ".yaml");
  for (const char* fewer : {"samples", "gradient_samples"})  // the test would take minutes
    vehicle::set_option(configuration, fewer, fewer == std::string("samples") ? "128" : "12", method);
  const std::vector<double> before = drive(configuration);
  const std::set<std::string> options = options_set(GetParam());
  EXPECT_GE(options.size(), 6u);
  for (const SolverOptions& solver : configuration.methods) {
    if (solver.method() != method) continue;
    for (const OptionEntry& entry : list_options(solver)) {
      const std::string option = entry.declaration.name;
      if (!options.contains(option) || seldom.contains(option)) continue;
      if (changed(entry) == to_text(entry.value)) continue;  // 0, which other options may require
      vehicle::Configuration other = configuration;
      vehicle::set_option(other, method + "." + option, changed(entry), method);
      EXPECT_EQ(drive(other) == before, inert.contains(GetParam()) && inert.at(GetParam()).contains(option))
          << GetParam() << ": " << option << " " << to_text(entry.value) << " -> " << changed(entry);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Names, ConfigurationOptions,
                         ::testing::Values("paper", "published", "hardware", "default", "default_kinematic",
                                           "default_speed", "race", "race_obstacles", "racing_benchmark",
                                           "passenger_car"));

}  // namespace
}  // namespace slalom::evaluation
