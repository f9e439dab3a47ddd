// Every option of svg_mppi that a configuration sets changes what it drives.
// A tracker with an estimated pose keeps its place while the localiser is uncertain, from the first scan on,
// and where the localiser is sure of a wrong one.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>

#include "evaluation/tracking/tracking_meter.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"

namespace slalom::evaluation {
namespace {

const std::string method = "svg_mppi";

/// Options that change nothing in a configuration. A row that is no longer true fails. With one guide, as of
/// few samples, there are no others; the variance is adapted; q* of `paper` has the temperature of samples.
const std::map<std::string, std::set<std::string>> inert = {
    {"paper", {"restart_guides", "fit_all_guides", "variance", "fit_temperature"}},
    {"published", {"restart_guides", "fit_all_guides", "variance"}},
    {"hardware", {"restart_guides", "fit_all_guides", "variance"}},
    {"default_kinematic", {"variance"}},
    {"default_speed", {"variance"}},
    {"race", {"guides"}},
    {"race_obstacles", {"guides"}},
    {"racing_benchmark", {"guides"}}};

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

constexpr int scans = 200;
constexpr double period = 0.025;  // s
constexpr maps::Pose start{-3, -1.5, 0};

/// The three cars about the start: to the left, to the right and across in front. They hide most of the room.
std::array<maps::Pose, 3> cars_about_the_start(double sensor_x) {
  return {{{sensor_x, start.y + 0.55, 0},
           {sensor_x, start.y - 0.55, 0},
           {sensor_x + 0.75, start.y, 0.5 * std::numbers::pi}}};
}

/// A rectangular room, the same after half a turn about (0, 0), but for three pillars of the size of the
/// cars. Seen from the start turned by half a turn about (0, 0), they look as the cars look from the start.
maps::OccupancyGrid room_with_the_same_view_elsewhere(const sim::CarParameters& car, double sensor_x) {
  maps::OccupancyGrid map{
      .width = 320, .height = 200, .resolution = 0.05, .origin = {-8, -5, 0}, .cells = {}};
  map.cells.assign(static_cast<std::size_t>(map.width * map.height), maps::Occupancy::free);
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      bool occupied = row < 2 || column < 2 || row >= map.height - 2 || column >= map.width - 2;
      const maps::Point turned{-(map.origin.x + (column + 0.5) * map.resolution),
                               -(map.origin.y + (row + 0.5) * map.resolution)};
      for (const maps::Pose& pose : cars_about_the_start(sensor_x)) {
        const maps::Point in_car = maps::inverse_transform(pose, turned);
        occupied |= std::abs(in_car.x) <= 0.5 * car.length && std::abs(in_car.y) <= 0.5 * car.width;
      }
      if (occupied) map.at(column, row) = maps::Occupancy::occupied;
    }
  }
  return map;
}

TEST(TrackingMeter, ATrackerKeepsItsPlaceWhereTheLocaliserJumps) {
  sim::WorldOptions options{.time_step = period};
  options.lidar.noise = 0.02;
  const sim::CarParameters& car = options.car;
  const maps::Pose mount{car.rear_length + options.lidar.mount.x, options.lidar.mount.y, 0};
  const double sensor_x = start.x + options.lidar.mount.x;
  const maps::OccupancyGrid map = room_with_the_same_view_elsewhere(car, sensor_x);
  const auto track = std::make_shared<const sim::Track>(map);

  constexpr std::uint64_t seed = 1;
  sim::World world(options, track);
  world.reset(seed, std::array{start}, cars_about_the_start(sensor_x));
  TrackingMeter meter(TrackingMode::localised, map, world, 0, seed);
  // The same localiser as that of the meter, to see that it jumps.
  const maps::Pose rear_axle = sim::rear_axle(car, world.state(0));
  vehicle::Localiser localiser(
      map, vehicle::LocaliserOptions{.seed = seed, .laser_x = mount.x, .laser_y = mount.y});
  localiser.start_at(rear_axle);
  int sure_elsewhere = 0;
  for (int i = 0; i < scans; ++i) {
    const sim::Observation seen = world.observe(0);
    meter.observe(world, seen.scan);
    const vehicle::LocaliserOutput& out = localiser.update({seen.scan, {}, seen.time});
    sure_elsewhere += out.status == vehicle::LocaliserStatus::ok &&
                      std::hypot(out.pose.x - rear_axle.x, out.pose.y - rear_axle.y) > 3;
    world.step(std::array{Command{}});
    meter.moved(world.state(0), period);
  }
  EXPECT_GT(sure_elsewhere, scans / 4);
  const TrackingRecord record = meter.record();
  EXPECT_EQ(record.in_view, 3 * scans);
  // At the localiser's pose the cars are pillars of the map: no object.
  EXPECT_GT(record.long_detected, 0.9 * record.long_in_view);
}

}  // namespace

}  // namespace slalom::evaluation
