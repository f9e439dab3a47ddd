#pragma once

#include <cstdio>
#include <nlohmann/json_fwd.hpp>

#include "slalom/evaluation/grid_race.hpp"

/// Races of several cars in words and as JSON.
namespace slalom::tools {

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
