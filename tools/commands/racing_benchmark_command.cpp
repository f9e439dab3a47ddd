
#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/racing_benchmark.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

constexpr const char* gap_driver = "follow_the_gap";

struct BenchmarkArguments {
  ScenarioArguments scenario;  ///< its configuration and options
  std::string maps, driver = "svg_mppi", car = vehicle::RacingCar{}.name, json;
  double margin = 0.12;  ///< m
  bool quick = false;
};

int drive_benchmark(const BenchmarkArguments& arguments) {
  std::FILE* const words = arguments.json == "-" ? stderr : stdout;
  const bool gap = arguments.driver == gap_driver;
  Json summary{{"driver", arguments.driver}};
  if (!gap) {
    summary["config"] = arguments.scenario.config;
    summary["margin_m"] = arguments.margin;
    summary["car"] = arguments.car;
  }
  vehicle::RacingCar car = find_racing_car(arguments.car);
  car.margin = arguments.margin;
  std::fprintf(words, "%-4s %10s %10s %12s\n", "map", "mean, s", "completed", "beyond grip");
  for (const char* name : racing_maps) {
    const RacingMap map = load_racing_map(arguments.maps, name);
    const auto driver =
        gap ? make_gap_driver()
            : make_planner_driver(map, load_configuration(arguments.scenario, arguments.driver),
                                  arguments.driver, car);
    const auto laps = drive_benchmark_laps(map, driver, arguments.quick ? 1 : racing_laps);
    const Json results = racing_results(laps);
    summary["maps"][name] = results;
    const Json& mean = results["mean"];
    std::fprintf(words, "%-4s %10s %4d of %2zu %10.2f %%\n", name,
                 mean.is_null() ? "-" : short_number(mean.get<double>()).c_str(),
                 results["completed"].get<int>(), laps.size(), 100 * results["beyond_grip"].get<double>());
    std::fflush(words);
  }
  if (!arguments.json.empty()) write_json(summary, arguments.json);
  return 0;
}

}  // namespace

void declare_racing_benchmark(Subcommand& command) {
  command.summary(
      "Drive the racing benchmark of Evans et al. (arXiv 2402.18558): lap times on its four maps");
  const auto arguments = std::make_shared<BenchmarkArguments>();
  arguments->scenario.config = "racing_benchmark";
  command.option("maps", arguments->maps,
                 "Folder of the benchmark's maps aut, esp, gbr and mco, with their centre lines",
                 {.required = true});
  command.option("--driver", arguments->driver,
                 "follow_the_gap, or a method, with which a planner drives along the minimum-time raceline");
  command.option("--config", arguments->scenario.config, config_help);
  command.option("--set", arguments->scenario.set, "section.option=value; may be repeated");
  command.option(
      "--margin", arguments->margin,
      "Distance that the car on the raceline keeps from walls, m; in narrow places less, down to 0.4 "
      "of it",
      {0, 10});
  command.option("--car", arguments->car, car_help);
  command.flag("--quick", arguments->quick, "Drive one lap of each map instead of ten");
  command.json(arguments->json, "the results");
  command.examples(
      {"racing-benchmark MAPS --json racing.json", "racing-benchmark MAPS --driver follow_the_gap"});
  command.action([arguments] { return drive_benchmark(*arguments); });
}

}  // namespace slalom::tools
