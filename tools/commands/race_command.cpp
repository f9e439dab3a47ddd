#include "json/json.hpp"
#include "slalom/evaluation/race.hpp"
#include "slalom/vehicle/racing/racing_car.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/racing_benchmark.hpp"
#include "tools/racing/grid_race_job.hpp"
#include "tools/racing/race_result.hpp"
#include "tools/scenario/lap_json.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"
#include "tools/terminal/progress.hpp"

namespace slalom::tools {
namespace {

using evaluation::RacingLap;

struct RaceArguments {
  ScenarioArguments scenario;
  GridRaceArguments race;  ///< laps, seed and JSON file of both kinds, and what only several cars have
  std::string method = "svg_mppi", plot;
  bool standing = false;
  double friction = 0.9;
};

/// The acceleration (m/s^2) of a friction coefficient.
double acceleration_of(double friction) {
  vehicle::RacingCar car;
  vehicle::set_friction(car, friction);
  return car.limits.lateral_acceleration;
}

/// Laps against the clock and their outputs.
class RaceJob {
 public:
  explicit RaceJob(const RaceArguments& arguments)
      : arguments_(arguments),
        words_(arguments.race.json == "-" ? stderr : stdout),
        scenario_(load_scenario(arguments.scenario, arguments.method)),
        setup_{scenario_.environment, {scenario_.configuration, arguments.method}, scenario_.lap},
        settings_(settings_json(arguments.scenario, scenario_, arguments.method)) {
    setup_.validate();
    settings_["seed"] = arguments.race.seed;
    settings_["laps"] = arguments.race.laps;
    settings_["standing"] = arguments.standing;
    settings_["friction"] = arguments.friction;
    settings_["timeout_s"] = setup_.timeout();
    settings_["control_period_s"] = setup_.control_period();
    race_.length = setup_.length();
    race_.grip = acceleration_of(arguments.friction);
    race_.profile = evaluation::profile_lap(setup_, false, race_.grip);
    race_.profile_from_rest = evaluation::profile_lap(setup_, true, race_.grip);
  }

  /// The exit status.
  int run() {
    print_notes(words_, scenario_);
    std::fprintf(words_, "%s on %s, configuration %s, %.1f m, %d obstacle%s, seed %llu\n",
                 arguments_.method.c_str(), scenario_.environment->course.name.c_str(),
                 arguments_.scenario.config.c_str(), race_.length, scenario_.lap.obstacles,
                 scenario_.lap.obstacles == 1 ? "" : "s",
                 static_cast<unsigned long long>(arguments_.race.seed));
    print_lap_header(words_, race_.grip);
    if (scenario_.environment->course.closed) print_lap(words_, "profile", race_.profile, race_.grip);
    print_lap(words_, "profile from rest", race_.profile_from_rest, race_.grip);
    drive();
    if (race_.laps.empty()) return 1;
    write_results();
    const auto flying = race_statistics(race_, false), standing = race_statistics(race_, true);
    return flying.completed + standing.completed == arguments_.race.laps ? 0 : 1;
  }

 private:
  void drive() {
    const InterruptFlag interrupt;
    ProgressLine progress(words_);
    const auto on_step = [&](int lap, const evaluation::ControlStep& step) {
      progress.show(lap + 1, arguments_.race.laps, step);
      if (step.output.solve) solve_ms_.push_back(static_cast<float>(1e3 * step.output.solve->times.total));
    };
    const auto on_lap = [&](const RacingLap& lap) {
      progress.clear();
      race_.laps.push_back(lap);
      const std::string label = std::to_string(race_.laps.size()) + (lap.standing ? " standing" : " flying");
      print_lap(words_, label, lap, race_.grip);
    };
    evaluation::drive_race(
        setup_, {.laps = arguments_.race.laps, .seed = arguments_.race.seed, .standing = arguments_.standing},
        {.on_step = on_step, .on_lap = on_lap}, &interrupt.raised());
    if (!interrupt.raised()) return;
    progress.clear();
    std::fprintf(words_, "interrupted after %zu of %d laps\n", race_.laps.size(), arguments_.race.laps);
  }

  void write_results() {
    print_statistics(words_, race_);
    const RacingLap* best = best_lap(race_);
    if (best) print_along(words_, race_, *best);
    if (!arguments_.race.json.empty()) write_json(results(), arguments_.race.json);
    if (arguments_.plot.empty()) return;
    if (!best) {
      std::fprintf(words_, "note: no picture, since no lap was completed\n");
      return;
    }
    plot(*best);
    std::fprintf(words_, "picture: %s\n", arguments_.plot.c_str());
  }

  Json results() const {
    Json json = results_json(settings_, scenario_);
    json.update(race_json(race_));
    json["solve_ms"] = times_json(solve_ms_);
    return json;
  }

  void plot(const RacingLap& best) const {
    const auto use = evaluation::grip_use(best.samples, race_.grip);
    const std::string facts =
        formatted("configuration %s \xC2\xB7 %.1f m \xC2\xB7 acceleration p50 %.2f, p99 %.2f m/s\xC2\xB2",
                  arguments_.scenario.config.c_str(), race_.length, use.p50, use.p99);
    const RacingLap& profile = profile_of(race_, best);
    const char* const name = profile.standing ? "profile from rest, %.3f s" : "profile, %.3f s";
    draw_race({.lap = {lap_words(race_, best), best},
               .profile = {formatted(name, profile.time()), profile},
               .length = race_.length,
               .grip = race_.grip,
               .title = arguments_.method + " on " + scenario_.environment->course.name,
               .facts = facts},
              arguments_.plot);
  }

  const RaceArguments& arguments_;
  std::FILE* words_;
  Scenario scenario_;
  evaluation::LapSetup setup_;
  Json settings_;
  RaceResult race_;
  std::vector<float> solve_ms_;
};

/// Several cars, or laps against the clock.
int run_race(const Subcommand& command, const RaceArguments& arguments) {
  const bool grid = command.given("--cars") || command.given("--against");
  for (const char* name : {"--races", "--jobs"})
    if (!grid && command.given(name)) throw CommandLineError(name, "needs --cars or --against");
  for (const char* name : {"--standing", "--friction", "--plot"})
    if (grid && command.given(name))
      throw CommandLineError(name, "is for laps against the clock, without --cars and --against");
  if (!grid) return RaceJob(arguments).run();
  return drive_grid_races(arguments.scenario, arguments.method, arguments.race);
}

/// The options of races of several cars.
void add_grid_options(Subcommand& command, GridRaceArguments& several) {
  command.option("--cars", several.cars,
                 "A race of so many cars, each with its own planner, LiDAR and tracker of the others",
                 {2, evaluation::most_race_cars});
  command.option(
      "--against", several.against,
      "METHOD, CONFIG or CONFIG:METHOD of another car; may be repeated. If --cars is more, the own car "
      "and these follow again in turn. --set applies to the configuration of --config and to the world");
  command.option("--races", several.races,
                 "Number of races; the cars move by one place of the grid from each to the next",
                 {1, 100000});
  command.option("--jobs", several.jobs, "Number of races driven in parallel; results do not depend on it",
                 {1, 1024});
}

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

void declare_race(Subcommand& command) {
  command.summary(
      "Drive timed laps on tyres that saturate: lap times, sectors, grip used, and where time is lost; or a "
      "race of several cars");
  const auto arguments = std::make_shared<RaceArguments>();
  arguments->scenario.config = "race";
  arguments->scenario.saturating_tyres = true;
  add_scenario_options(command, arguments->scenario);
  add_method_option(command, arguments->method);
  command.option(
      "--seed", arguments->race.seed,
      "Seed of lap 1; a standing start in lap k has the seed SEED + (k - 1) (obstacles + 5), and race k "
      "SEED + k - 1");
  command.option(
      "--laps", arguments->race.laps,
      "Number of laps: a standing start, then flying laps; after a collision, a standing start again. "
      "In a race, those of each car",
      {1, 100000});
  add_grid_options(command, arguments->race);
  command.flag("--standing", arguments->standing, "Begin every lap with a standing start");
  command.option("--friction", arguments->friction,
                 "Radius of the friction circle with which accelerations are compared, in g", {0.01, 10.0});
  command.json(arguments->race.json, "the results");
  command.option("--plot", arguments->plot,
                 "Write a picture of the best lap to this PNG, SVG or PDF: speed and profile, time behind, "
                 "accelerations");
  command.examples(
      {"race --course fox --laps 10 --plot race.png", "race --course fox --cars 4 --against mppi"});
  command.action([&command, arguments] { return run_race(command, *arguments); });
}

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
