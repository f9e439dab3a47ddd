#include "tools/racing/grid_race_job.hpp"

#include <mutex>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/evaluation/worker_threads.hpp"
#include "slalom/solvers/registry.hpp"
#include "tools/scenario/lap_json.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"
#include "tools/terminal/progress.hpp"

namespace slalom::tools {
namespace {

using evaluation::GridRaceResult;

/// Reads a driver: a configuration by name or file, and a method.
struct RaceDriver {
  std::string config, method;
  bool own = true;  ///< the configuration is that of --config, with every --set
};

/// A value of --against: METHOD, CONFIG or CONFIG:METHOD.
RaceDriver race_driver(const std::string& text, const RaceDriver& own) {
  const auto methods = solver_names();
  if (std::find(methods.begin(), methods.end(), text) != methods.end()) return {own.config, text, true};
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(text)) return {text, own.method, false};
  return {text.substr(0, colon), text.substr(colon + 1), false};
}

/// The drivers of all cars: the own one and the others, in turn.
std::vector<RaceDriver> race_drivers(const ScenarioArguments& scenario, const std::string& method,
                                     const GridRaceArguments& arguments) {
  std::vector<RaceDriver> different{{scenario.config, method}};
  for (const std::string& text : arguments.against) different.push_back(race_driver(text, different[0]));
  const int named = static_cast<int>(different.size()), cars = arguments.cars > 0 ? arguments.cars : named;
  if (named > evaluation::most_race_cars)
    throw CommandLineError("--against", "at most " + std::to_string(evaluation::most_race_cars - 1) +
                                            " times, for a race of " +
                                            std::to_string(evaluation::most_race_cars) + " cars");
  if (cars < std::max(named, 2))
    throw CommandLineError("--cars", std::to_string(cars) + " must be at least " +
                                         std::to_string(std::max(named, 2)) + ", with --against counted");
  std::vector<RaceDriver> drivers;
  for (int i = 0; i < cars; ++i) drivers.push_back(different[static_cast<std::size_t>(i % named)]);
  return drivers;
}

/// A configuration as results name it.
std::string short_name(const std::string& config) {
  const std::filesystem::path path(config);
  return path.extension() == ".yaml" ? path.stem().string() : config;
}

/// The configuration, with the method where they differ, and a number where two cars have the same.
std::vector<std::string> names_of(const std::vector<RaceDriver>& drivers) {
  const bool methods_differ = std::any_of(drivers.begin(), drivers.end(), [&](const RaceDriver& driver) {
    return driver.method != drivers[0].method;
  });
  std::vector<std::string> kinds, names;
  for (const RaceDriver& driver : drivers)
    kinds.push_back(short_name(driver.config) + (methods_differ ? ":" + driver.method : ""));
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const auto same = std::count(kinds.begin(), kinds.end(), kinds[i]);
    const auto before = std::count(kinds.begin(), kinds.begin() + static_cast<std::ptrdiff_t>(i), kinds[i]);
    names.push_back(same > 1 ? kinds[i] + " " + std::to_string(before + 1) : kinds[i]);
  }
  return names;
}

/// Races of several cars and their outputs.
class GridRaceJob {
 public:
  GridRaceJob(const ScenarioArguments& scenario, const std::string& method,
              const GridRaceArguments& arguments)
      : arguments_(arguments),
        words_(arguments.json == "-" ? stderr : stdout),
        drivers_(race_drivers(scenario, method, arguments)),
        scenario_(load_scenario(scenario, method)),
        settings_(settings_json(scenario, scenario_, method)) {
    races_.names = names_of(drivers_);
    settings_["seed"] = arguments.seed;
    settings_["laps"] = arguments.laps;
    settings_["races"] = arguments.races;
    settings_["cars"] = Json::array();
    race_ = {scenario_.environment, {}, scenario_.lap, arguments.laps};
    for (std::size_t i = 0; i < drivers_.size(); ++i) {
      const RaceDriver& driver = drivers_[i];
      race_.drivers.push_back({scenario_.configuration, driver.method});
      Json car{{"name", races_.names[i]}, {"config", driver.config}, {"method", driver.method}};
      if (!driver.own) {
        ScenarioArguments other{.config = driver.config};
        race_.drivers.back().configuration = load_configuration(other, driver.method);
        car["options"] = options_json(race_.drivers.back().configuration, driver.method);
      }
      settings_["cars"].push_back(std::move(car));
    }
    race_.validate();
    settings_["lap_length_m"] = race_.lap_length();
    settings_["timeout_s"] = race_.timeout();
    settings_["control_period_s"] = race_.control_period();
  }

  /// The exit status.
  int run() {
    print_notes(words_, scenario_);
    std::fprintf(words_, "%d race%s of %zu cars on %s, %d lap%s of %.1f m, seed %llu\n", arguments_.races,
                 arguments_.races == 1 ? "" : "s", drivers_.size(),
                 scenario_.environment->course.name.c_str(), arguments_.laps, arguments_.laps == 1 ? "" : "s",
                 race_.lap_length(), static_cast<unsigned long long>(arguments_.seed));
    drive();
    if (races_.results.empty()) return 1;
    if (arguments_.races == 1) print_standings(words_, races_.names, races_.results[0]);
    print_race_summary(words_, races_);
    if (!arguments_.json.empty()) write_json(results(), arguments_.json);
    const auto held = std::count_if(races_.results.begin(), races_.results.end(),
                                    [](const auto& race) { return !race.cancelled && race.has_winner(); });
    return held == arguments_.races ? 0 : 1;
  }

 private:
  /// Drives the races in several threads, and reports them in their order.
  void drive() {
    const InterruptFlag interrupt;
    ProgressLine progress(words_);
    std::vector<std::optional<GridRaceResult>> ended(static_cast<std::size_t>(arguments_.races));
    std::mutex mutex;
    std::size_t reported = 0;
    const auto drive_one = [&](int number) {
      evaluation::GridRaceCallback on_step;
      if (arguments_.jobs == 1)
        on_step = [&](const evaluation::GridRaceStep& step) {
          progress.show(number + 1, arguments_.races, step);
        };
      GridRaceResult result = race_.run(arguments_.seed + static_cast<std::uint64_t>(number), number, on_step,
                                        &interrupt.raised());
      const std::lock_guard lock(mutex);
      progress.clear();
      ended[static_cast<std::size_t>(number)] = std::move(result);
      for (; reported < ended.size() && ended[reported]; ++reported)
        if (arguments_.races > 1)
          print_race_line(words_, races_.names, *ended[reported], static_cast<int>(reported) + 1);
    };
    evaluation::for_each_in_threads(arguments_.jobs, arguments_.races, drive_one, &interrupt.raised());
    for (auto& race : ended)
      if (race) races_.results.push_back(std::move(*race));
  }

  Json results() const {
    Json json = results_json(settings_, scenario_);
    json.update(grid_races_json(races_));
    std::vector<float> solve_ms;
    for (const GridRaceResult& race : races_.results)
      for (const evaluation::CarResult& car : race.cars)
        solve_ms.insert(solve_ms.end(), car.solve_ms.begin(), car.solve_ms.end());
    json["solve_ms"] = times_json(solve_ms);
    return json;
  }

  const GridRaceArguments& arguments_;
  std::FILE* words_;
  std::vector<RaceDriver> drivers_;
  Scenario scenario_;
  Json settings_;
  evaluation::GridRace race_;
  GridRaces races_;
};

}  // namespace

int drive_grid_races(const ScenarioArguments& scenario, const std::string& method,
                     const GridRaceArguments& arguments) {
  return GridRaceJob(scenario, method, arguments).run();
}

}  // namespace slalom::tools
