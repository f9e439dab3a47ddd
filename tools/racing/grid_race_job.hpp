#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdio>

#include "slalom/evaluation/grid_race.hpp"
#include "tools/scenario/scenario.hpp"

/// Races of several cars in words and as JSON.
namespace slalom::tools {

/// The arguments of `slalom race` with several cars.
struct GridRaceArguments {
  int cars = 0;                      ///< 0: the own one and those of `against`
  std::vector<std::string> against;  ///< METHOD, CONFIG or CONFIG:METHOD
  int races = 1, laps = 5, jobs = 1;
  std::uint64_t seed = 0;  ///< seed of the first race
  std::string json;        ///< a file, "-" or empty
};

/// Races of several cars, the own one with the configuration of `scenario` and `method`. Prints standings and
/// writes results. Returns the exit status: 0 if every race was driven to its end and has a winner. Throws
/// CommandLineError, IoError, std::invalid_argument, std::runtime_error.
int drive_grid_races(const ScenarioArguments& scenario, const std::string& method,
                     const GridRaceArguments& arguments);

/// Races with the names of their cars.
struct GridRaces {
  std::vector<std::string> names;                   ///< in the order of the entries
  std::vector<evaluation::GridRaceResult> results;  ///< in the order of the races
};

/// The standings of a race and its contacts.
void print_standings(std::FILE* out, const std::vector<std::string>& names,
                     const evaluation::GridRaceResult& race);
/// A race in a line; `number` counts from 1.
void print_race_line(std::FILE* out, const std::vector<std::string>& names,
                     const evaluation::GridRaceResult& race, int number);
/// A row for each car over all races, and one for all cars.
void print_race_summary(std::FILE* out, const GridRaces& races);

/// `races` and `summary`. Nothing in it depends on the clock of the wall.
nlohmann::ordered_json grid_races_json(const GridRaces& races);

}  // namespace slalom::tools
