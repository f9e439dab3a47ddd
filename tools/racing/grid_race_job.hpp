#pragma once

#include "tools/scenario/scenario.hpp"

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

}  // namespace slalom::tools
