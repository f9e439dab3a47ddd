#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdio>

#include "slalom/evaluation/race.hpp"

namespace slalom::tools {

/// Laps of a race, and the laps that the speed profile of the course asks for.
struct RaceResult {
  double length = 0;  ///< m, of a lap
  double grip = 0;    ///< m/s^2, radius of the circle with which accelerations are compared
  evaluation::RacingLap profile, profile_from_rest;
  std::vector<evaluation::RacingLap> laps;
};

/// The flying laps or the standing starts of a race. Times and grip are those of the completed laps.
struct RaceStatistics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();  ///< without completed laps

  int laps = 0, completed = 0;
  double mean = none, best = none;  ///< s
  int best_lap = -1;                ///< index in RaceResult::laps; -1 without completed laps
  std::array<double, evaluation::racing_sectors> best_sector{none, none, none};  ///< s, of all completed laps
  evaluation::GripUse grip;

  double ideal() const noexcept;  ///< s, sum of the best sectors
};
/// Calls `visit(value, Figure)` for every figure of the statistics in the order of tables.
template <class Visit>
void visit_figures(const RaceStatistics& statistics, Visit&& visit) {
  visit(statistics.laps, evaluation::Figure{"laps", "", "laps, completed or not"});
  visit(statistics.completed, evaluation::Figure{"completed", "", "completed laps"});
  visit(statistics.mean, evaluation::Figure{"mean", "s", "mean time of the completed laps"});
  visit(statistics.best, evaluation::Figure{"best", "s", "time of the best lap"});
  visit(statistics.best_lap + 1, evaluation::Figure{"best_lap", "", "number of the best lap; 0: none"});
  visit(statistics.best_sector, evaluation::Figure{"best_sectors", "s", "best times of the sectors"});
  visit(statistics.ideal(), evaluation::Figure{"ideal", "s", "sum of the best sectors"});
  visit_figures(statistics.grip, visit);
}
RaceStatistics race_statistics(const RaceResult& race, bool standing);

/// The lap of the profile with the start of `lap`.
const evaluation::RacingLap& profile_of(const RaceResult& race, const evaluation::RacingLap& lap);

/// The lap that stands for a race: the best flying one, or else standing start. None without completed laps.
const evaluation::RacingLap* best_lap(const RaceResult& race);

/// `length_m`, `friction_circle_mps2`, `profile` and `profile_from_rest`, `flying` and `standing`
/// (statistics), and `laps`, each with its samples.
nlohmann::ordered_json race_json(const RaceResult& race);

// Tables.

/// The names of the columns, with the friction circle (m/s^2).
void print_lap_header(std::FILE* out, double grip);
/// A lap as a row: time, sectors, highest speed, grip used.
void print_lap(std::FILE* out, const std::string& label, const evaluation::RacingLap& lap, double grip);
/// A table of flying laps and standing starts: completed laps, mean, best, sum of the best sectors, how much
/// the best takes longer than the profile, grip used.
void print_statistics(std::FILE* out, const RaceResult& race);
/// The way in ten parts: speeds of a lap and of the profile, and the time behind the profile.
void print_along(std::FILE* out, const RaceResult& race, const evaluation::RacingLap& lap);

/// A result as a sentence: "lap 3 (flying) 12.345 s".
std::string lap_words(const RaceResult& race, const evaluation::RacingLap& lap);

/// A lap and its name in the key.
struct NamedLap {
  std::string name;
  const evaluation::RacingLap& lap;
};

/// The content of a picture of a lap against the clock.
struct RacePicture {
  NamedLap lap;       ///< the lap that is shown
  NamedLap profile;   ///< the lap of the course's speed profile
  double length = 0;  ///< m, of the lap
  double grip = 0;    ///< m/s^2, radius of the friction circle
  std::string title, facts;
};

/// Draws the speed along the lap beside the profile, how far the lap is behind along the way, and its
/// accelerations in the friction circle. Writes PNG, SVG or PDF; throws IoError.
void draw_race(const RacePicture& picture, const std::filesystem::path& file);

}  // namespace slalom::tools
