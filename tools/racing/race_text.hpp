#pragma once

#include <cstdio>
#include <string>

#include "tools/racing/race_result.hpp"

/// The tables of `slalom race`.
namespace slalom::tools {

/// The names of the columns, with the friction circle (m/s^2).
void print_lap_header(std::FILE* out, double grip);
/// A lap as a row: time, sectors, highest speed, grip used.
void print_lap(std::FILE* out, const std::string& label, const evaluation::RacingLap& lap, double grip);
/// A table of flying laps and standing starts: completed laps, mean, best, sum of the best sectors, how much
/// the best takes longer than the profile, grip used.
void print_statistics(std::FILE* out, const RaceResult& race);
/// The way in ten parts: speeds of a lap and of the profile, and times behind the profile and behind `other`
/// (may be null), which is called `other_name`.
void print_along(std::FILE* out, const RaceResult& race, const evaluation::RacingLap& lap,
                 const evaluation::RacingLap* other, const std::string& other_name);

/// A result as a sentence: "lap 3 (flying) 12.345 s".
std::string lap_words(const RaceResult& race, const evaluation::RacingLap& lap);

}  // namespace slalom::tools
