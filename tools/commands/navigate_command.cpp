#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "slalom/evaluation/json.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

using evaluation::RoomDrive;
using evaluation::RoomDriver;
using evaluation::RoomOutcome;
using evaluation::RoomScenario;

struct NavigateArguments {
  std::string scenario = "all", methods = "svg_mppi,mppi", json, pictures;
  int seeds = 5;
  std::uint64_t first_seed = 1;
  bool without_detours = false;
};

/// A driver, and what the tables call it.
struct NamedDriver {
  std::string name;
  RoomDriver driver;
};

/// The drives of a driver in a scenario.
struct Series {
  const RoomScenario* scenario;
  const NamedDriver* driver;
  std::vector<RoomDrive> drives;
};

/// The rollouts of a solve of svg_mppi with these options: its samples and those of the guides' steps.
int rollouts(const SvgMppiOptions& o) {
  return o.samples + o.guides.count * o.guides.iterations * o.guides.gradient_samples;
}

RoomDriver driver_of(const std::string& method, bool detours) {
  RoomDriver driver;
  driver.navigator.find_detours = detours;
  const SvgMppiOptions svg = navigation::svg_mppi_options({});
  if (method == "svg_mppi") {
    driver.solver = svg;
  } else if (method == "mppi") {
    MppiOptions mppi = navigation::mppi_options({});
    mppi.samples = rollouts(svg);
    driver.solver = mppi;
  } else {
    throw CommandLineError("--methods", method + ": must be svg_mppi or mppi");
  }
  return driver;
}

std::vector<NamedDriver> drivers_of(const NavigateArguments& arguments) {
  std::vector<NamedDriver> drivers;
  std::string rest = arguments.methods + ",";
  for (std::size_t comma; (comma = rest.find(',')) != std::string::npos; rest.erase(0, comma + 1)) {
    const std::string method = rest.substr(0, comma);
    drivers.push_back({method, driver_of(method, true)});
    if (arguments.without_detours) drivers.push_back({method + " alone", driver_of(method, false)});
  }
  return drivers;
}

template <class Value>
std::vector<double> values_of(const Series& series, Value&& value) {
  std::vector<double> values;
  for (const RoomDrive& drive : series.drives) values.push_back(static_cast<double>(value(drive)));
  return values;
}

Json mean_of(const std::vector<double>& values) {
  const evaluation::Interval interval = evaluation::bootstrap_mean(values);
  return {{"mean", evaluation::mean(values)}, {"low", interval.low}, {"high", interval.high}};
}

Json summary_of(const Series& series) {
  int successes = 0, collisions = 0;
  double slowest = 0;
  Json drives = Json::array();
  for (const RoomDrive& d : series.drives) {
    successes += d.success;
    collisions += d.outcome == RoomOutcome::collision;
    slowest = std::max(slowest, d.update_max);
    drives.push_back({{"outcome", evaluation::name(d.outcome)},
                      {"success", d.success},
                      {"time_s", d.time},
                      {"length_m", d.length},
                      {"side_changes", d.side_changes},
                      {"reversals", d.reversals},
                      {"answer_time_s", d.answer_time},
                      {"update_p50_ms", 1e3 * d.update_p50},
                      {"update_max_ms", 1e3 * d.update_max}});
  }
  const auto count = static_cast<std::int64_t>(series.drives.size());
  const evaluation::Interval interval = evaluation::wilson_interval(successes, count);
  return {{"scenario", series.scenario->name},
          {"driver", series.driver->name},
          {"drives", count},
          {"successes", successes},
          {"success_rate", {{"low", interval.low}, {"high", interval.high}}},
          {"collisions", collisions},
          {"time_s", mean_of(values_of(series, [](const RoomDrive& d) { return d.time; }))},
          {"length_m", mean_of(values_of(series, [](const RoomDrive& d) { return d.length; }))},
          {"side_changes", mean_of(values_of(series, [](const RoomDrive& d) { return d.side_changes; }))},
          {"reversals", mean_of(values_of(series, [](const RoomDrive& d) { return d.reversals; }))},
          {"update_max_ms", 1e3 * slowest},
          {"by_seed", drives}};
}

bool collided(const RoomDrive& drive) {
  return drive.outcome == RoomOutcome::collision;
}

void print_row(const Series& series, std::ostream& out) {
  const auto mean = [&](auto&& value) { return evaluation::mean(values_of(series, value)); };
  const auto count = [&](auto&& holds) {
    return static_cast<int>(std::count_if(series.drives.begin(), series.drives.end(), holds));
  };
  char text[256];
  std::snprintf(text, sizeof text, "%-15s %-15s %3d/%-3d %10d %8.1f %8.1f %12.1f %10.1f\n",
                series.scenario->name, series.driver->name.c_str(),
                count([](const RoomDrive& d) { return d.success; }), static_cast<int>(series.drives.size()),
                count(collided), mean([](const RoomDrive& d) { return d.time; }),
                mean([](const RoomDrive& d) { return d.length; }),
                mean([](const RoomDrive& d) { return d.side_changes; }),
                mean([](const RoomDrive& d) { return d.reversals; }));
  out << text << std::flush;
}

constexpr Colour colours[] = {
    {0.10, 0.42, 0.75, 0.75}, {0.85, 0.36, 0.13, 0.75}, {0.16, 0.60, 0.38, 0.75}, {0.55, 0.33, 0.65, 0.75}};

/// The ways that all drivers took in a scenario.
void draw(const std::vector<Series>& all, const RoomScenario& scenario, const std::string& folder) {
  MapPicture picture(sim::map_of(scenario.room, 0.05));
  for (const sim::Box& box : scenario.room.obstacles) {
    const auto corners = sim::corners(box);
    picture.polygon({corners.begin(), corners.end()}, {0.55, 0.58, 0.63, 1}, {0.3, 0.33, 0.38, 1});
  }
  std::vector<std::pair<std::string, Colour>> key;
  std::size_t index = 0;
  for (const Series& series : all) {
    if (series.scenario != &scenario) continue;
    const Colour colour = colours[index++ % std::size(colours)];
    key.emplace_back(series.driver->name, colour);
    for (const RoomDrive& drive : series.drives) {
      std::vector<maps::Point> points;
      for (const maps::Pose& pose : drive.trace) points.push_back({pose.x, pose.y});
      picture.line(points, colour, 3, false);
      const auto end = sim::corners({drive.trace.back(), 0.7, 0.5});
      picture.line({end.begin(), end.end()}, colour, 2, true);
    }
  }
  picture.arrow(scenario.start, 20, {0.13, 0.16, 0.22, 1});
  picture.arrow(scenario.goal, 20, {0.13, 0.16, 0.22, 1});
  picture.key(scenario.name, scenario.summary, key);
  picture.save(std::filesystem::path(folder) / (std::string(scenario.name) + ".png"));
}

int navigate(const NavigateArguments& arguments) {
  std::vector<const RoomScenario*> scenarios;
  if (arguments.scenario == "all") {
    for (const RoomScenario& each : evaluation::room_scenarios()) scenarios.push_back(&each);
  } else {
    scenarios.push_back(&evaluation::room_scenario(arguments.scenario));
  }
  const std::vector<NamedDriver> drivers = drivers_of(arguments);
  std::ostream& words = arguments.json == "-" ? std::cerr : std::cout;
  words << "scenario        driver          success collisions   time s length m side changes  reversals\n";
  std::vector<Series> all;
  Json rows = Json::array();
  bool collision_free = true;
  for (const RoomScenario* scenario : scenarios)
    for (const NamedDriver& driver : drivers) {
      Series series{scenario, &driver, {}};
      for (int i = 0; i < arguments.seeds; ++i)
        series.drives.push_back(
            drive_room(*scenario, driver.driver, arguments.first_seed + static_cast<std::uint64_t>(i)));
      rows.push_back(summary_of(series));
      print_row(series, words);
      collision_free = collision_free && std::none_of(series.drives.begin(), series.drives.end(), collided);
      all.push_back(std::move(series));
    }
  if (!arguments.pictures.empty()) {
    std::filesystem::create_directories(arguments.pictures);
    for (const RoomScenario* scenario : scenarios) draw(all, *scenario, arguments.pictures);
  }
  if (!arguments.json.empty())
    write_json({{"seeds", arguments.seeds}, {"first_seed", arguments.first_seed}, {"results", rows}},
               arguments.json);
  return collision_free ? 0 : 1;
}

}  // namespace

void declare_navigate(Subcommand& command) {
  command.summary("Drive a mobile robot through rooms, with several methods on the same seeds");
  const auto arguments = std::make_shared<NavigateArguments>();
  command.option("--scenario", arguments->scenario, "Name of a scenario, or all").show_default();
  command.option("--methods", arguments->methods, "Methods that drive: svg_mppi, mppi, or both with a comma")
      .show_default();
  command.flag("--without-detours", arguments->without_detours,
               "Let each method drive a second time without the search for detours");
  command.option("--seeds", arguments->seeds, "Drives of each method in each scenario")
      .range(1, 100000)
      .show_default();
  command.option("--first-seed", arguments->first_seed, "Seed of the first drive").show_default();
  command.option("--pictures", arguments->pictures, "Write a picture of each scenario to this folder");
  command.option("--json", arguments->json,
                 "Write the results as JSON to this file, or to standard output: -");
  std::string names = "Scenarios:\n";
  for (const RoomScenario& each : evaluation::room_scenarios())
    names += std::string("  ") + each.name + ": " + each.summary + "\n";
  command.footer(names + "The status is 1 if a drive ended in a collision.");
  command.action([arguments] { return navigate(*arguments); });
}

}  // namespace slalom::tools
