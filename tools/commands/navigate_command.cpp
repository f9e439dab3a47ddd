
#include "json/json.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/evaluation/worker_threads.hpp"
#include "slalom/solvers/registry.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/navigate_report.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

using evaluation::RoomDriver;
using evaluation::RoomScenario;

struct NavigateArguments {
  std::string scenario = "rooms", json, pictures, barn;
  int barn_step = 1;
  std::vector<std::string> methods{"svg_mppi", "mppi"}, set;
  int seeds = 5, jobs = 1;
  std::uint64_t first_seed = 1;
};

RoomDriver driver_of(const NavigateArguments& arguments, const std::string& method,
                     const RoomScenario& scenario) {
  RoomDriver driver;
  driver.predict_movers = scenario.optimal_time == 0;  // nothing moves in BARN
  driver.solver = navigation::method_options(method, scenario.base);
  for (const std::string& text : arguments.set) {
    const std::string key = text.substr(0, text.find('=')),
                      value = text.substr(std::min(text.size(), key.size() + 1));
    const bool known = for_option("--set", [&] {
      return set_option(driver.solver, key, value) || set_option(driver.navigator, key, value);
    });
    if (!known)
      throw CommandLineError("--set", text, "must be key=value with an option of navigator or " + method);
  }
  return driver;
}

void check_methods(const std::vector<std::string>& methods) {
  for (const std::string& method : methods) {
    for_option("--methods", [&] { return solver_options(method); });
    if (std::count(methods.begin(), methods.end(), method) > 1)
      throw CommandLineError("--methods", method, "is given twice");
  }
}

/// Writes the results so far to the files, and at the end to standard output where that is wanted.
void write_results(const NavigateArguments& arguments, const std::vector<RoomSeries>& all, bool is_last) {
  if (arguments.json.empty() || (arguments.json == "-" && !is_last)) return;
  Json rows = Json::array();
  for (const RoomSeries& series : all) rows.push_back(summary_of(series));
  write_json({{"seeds", all.front().drives.size()}, {"first_seed", arguments.first_seed}, {"results", rows}},
             arguments.json);
}

/// Adds the drive of a seed to each series. Drives do not depend on each other, so threads change no result.
void drive_all(const NavigateArguments& arguments, std::uint64_t seed, std::vector<RoomSeries>& all) {
  std::vector<evaluation::RoomDrive> drives(all.size());
  evaluation::for_each_in_threads(arguments.jobs, static_cast<int>(all.size()), [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    const RoomScenario& scenario = *all[k].scenario;
    const double timeout = arguments.barn.empty() ? 60 : 100;
    drives[k] = drive_room(scenario, driver_of(arguments, all[k].driver, scenario), seed, timeout);
  });
  for (std::size_t k = 0; k < all.size(); ++k) all[k].drives.push_back(std::move(drives[k]));
}

int navigate(const NavigateArguments& arguments) {
  std::vector<const RoomScenario*> scenarios;
  std::vector<RoomScenario> barn;
  if (!arguments.barn.empty()) {
    barn = evaluation::barn_scenarios(arguments.barn, arguments.barn_step);
    for (const RoomScenario& each : barn) scenarios.push_back(&each);
  } else if (arguments.scenario == "rooms" || arguments.scenario == "manoeuvres") {
    for (const RoomScenario& each :
         arguments.scenario == "rooms" ? evaluation::room_scenarios() : evaluation::manoeuvre_scenarios())
      scenarios.push_back(&each);
  } else {
    scenarios.push_back(
        for_option("--scenario", [&] { return &evaluation::room_scenario(arguments.scenario); }));
  }
  check_methods(arguments.methods);
  for (const std::string& method : arguments.methods) driver_of(arguments, method, *scenarios.front());
  std::vector<RoomSeries> all;
  for (const RoomScenario* scenario : scenarios)
    for (const std::string& method : arguments.methods) all.push_back({scenario, method, {}});
  // Seed by seed, so that what is written when a long run is stopped is complete up to a seed.
  for (int i = 0; i < arguments.seeds; ++i) {
    const std::uint64_t seed = arguments.first_seed + static_cast<std::uint64_t>(i);
    drive_all(arguments, seed, all);
    write_results(arguments, all, i + 1 == arguments.seeds);
  }
  print(all, arguments.json == "-" ? stderr : stdout);
  if (!arguments.pictures.empty()) {
    std::filesystem::create_directories(arguments.pictures);
    for (const RoomScenario* scenario : scenarios) draw(all, *scenario, arguments.pictures);
  }
  const bool collision_free = std::all_of(all.begin(), all.end(), [](const RoomSeries& series) {
    return std::none_of(series.drives.begin(), series.drives.end(), collided);
  });
  return collision_free ? 0 : 1;
}

}  // namespace

void declare_navigate(Subcommand& command) {
  command.summary("Drive a mobile robot through rooms, with several methods on the same seeds");
  const auto arguments = std::make_shared<NavigateArguments>();
  command.option("--scenario", arguments->scenario,
                 "Name of a scenario, or rooms or manoeuvres for all of these");
  command.option("--barn", arguments->barn,
                 "Drive through the worlds of the dataset BARN in this folder (docs/navigation.md)");
  command.option("--barn-step", arguments->barn_step, "Take every N-th world; BARN's test takes every 6th",
                 {1, 300});
  command.option("--methods", arguments->methods, "Methods, separated by commas: " + method_names(),
                 {.comma_separated = true});
  command.option("--seeds", arguments->seeds, "Number of drives of each method in each scenario",
                 {1, 100000});
  command.option("--seed", arguments->first_seed, "Seed of the first drive");
  command.option("--set", arguments->set,
                 "key=value: an option of the navigator or its method; can be repeated");
  command.option("--jobs", arguments->jobs, "Number of drives that run in parallel", {1, 1024});
  command.option("--pictures", arguments->pictures, "Write a picture of each scenario to this folder");
  command.json(arguments->json, "the results");
  std::string names;
  const auto add = [&](const char* kind, std::span<const RoomScenario> scenarios) {
    names += std::string(kind) + ":\n";
    for (const RoomScenario& each : scenarios) names += "  " + each.name + ": " + each.summary + "\n";
  };
  add("Rooms", evaluation::room_scenarios());
  add("Manoeuvres", evaluation::manoeuvre_scenarios());
  command.examples({"navigate --scenario crowd-crossing --seeds 20 --pictures pictures",
                    "navigate --scenario manoeuvres --methods svg_mppi --seeds 20"},
                   names + "The exit status is 1 if a drive ended in a collision.");
  command.action([arguments] { return navigate(*arguments); });
}

}  // namespace slalom::tools
