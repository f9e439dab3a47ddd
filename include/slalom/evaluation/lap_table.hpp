#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "slalom/evaluation/lap.hpp"

namespace slalom::evaluation {

/// An experiment: a method with options that differ from the configuration, in a scenario.
struct Experiment {
  std::string method;                                    ///< name of the method
  std::vector<std::pair<std::string, std::string>> set;  ///< key (section.option) and value, as text
  std::string scenario;                                  ///< "pt" (no obstacles) or "oa"
  int obstacles = 0;                                     ///< parked cars per lap
  int laps = 0;                                          ///< number

  /// The options that differ, for instance "svg_mppi.variance=0.05 vehicle.dead_time=0"; empty without any.
  /// Commas become semicolons.
  std::string set_text() const;
  /// Its name in tables: the method and set_text().
  std::string label() const;
  /// Whether it measures a tracker: sets world.tracking to another value than off.
  bool tracks() const;
  /// Whether there are opponents: sets world.opponents to another value than 0.
  bool has_opponents() const;
  /// Whether some of them have a planner: sets world.planning_opponents to another value than 0.
  bool has_planning_opponents() const;
};

/// The figures of OvertakingRecord for a lap with `world.opponents`.
struct OvertakingFigures {
  int met = 0;            ///< encounters; column `opponents_met`
  int overtaken = 0;      ///< those that ended with the opponent behind; column `overtaken`
  int not_overtaken = 0;  ///< those in which two times around the course were not enough; `not_overtaken`
  double duration = 0;    ///< s, mean until opponents were overtaken, 0 without any; `overtaking_time`
  int contacts = 0;       ///< with opponents; column `opponent_contacts`
  int caused = 0;         ///< those of them at which the car is at fault; column `contacts_caused`
  int side_changes = 0;   ///< Encounter::side_changes of all encounters; column of the same name
};

/// A row of `laps.csv`: one lap of one experiment. Columns whose names contain `calculation_time`, or begin
/// with `solve_` or `wall_`, hold wall-clock times (ms, but `wall_time` s); all others repeat exactly.
struct LapRow : LapFigures {
  int experiment = 0;    ///< index into the experiments of the evaluation
  int lap = 0;           ///< from 0
  bool success = false;  ///< finished without a collision
  double mean_calculation_time = 0, max_calculation_time = 0, min_calculation_time = 0;  ///< ms, of a solve
  int blocked_steps = 0;       ///< control steps in which every plan collided
  int degenerate_steps = 0;    ///< control steps without usable weights
  std::string contact_points;  ///< "x:y" in m, the car's position at its first collision with each body
  double solve_p50 = 0, solve_p99 = 0;  ///< ms
  double wall_time = 0;                 ///< s, to compute the lap
  TrackingFigures tracking;             ///< columns only in evaluations with `world.tracking`
  OvertakingFigures overtaking;         ///< columns only in evaluations with `world.opponents`
};

/// The row of a lap that has ended.
LapRow make_row(int experiment, int lap, const LapResult& result, double wall_time);

/// Whether an obstacle stood where the car starts (its centre of gravity is at `start`): the first collision
/// is within 0.05 m of the start. No driver avoids it.
bool began_in_contact(const LapRow& row, const maps::Pose& start);

/// The header of laps.csv: `method,scenario,set,lap`, the columns of the logs of Honda et al. (ICRA 2024),
/// then further ones, if one of the experiments tracks, those of TrackingFigures, and if one has opponents,
/// those of OvertakingFigures.
std::string csv_header(const std::vector<Experiment>& experiments = {});
/// A row of laps.csv without line end. Numbers read back to the same bits.
std::string csv_line(const LapRow& row, const std::vector<Experiment>& experiments);

/// A line of a table that is stored: the line, a comma, and its checksum, which is the 32-bit FNV-1a hash of
/// the bytes before the comma in eight hexadecimal digits. It tells every change of a single byte.
std::string checked_line(const std::string& line);
/// The header of such a table: csv_header() and the column `checksum`.
std::string checked_header(const std::vector<Experiment>& experiments = {});

/// Parses a line of csv_line. Throws std::invalid_argument naming the column, its value and the rule, or what
/// else is wrong with the line.
LapRow parse_line(const std::string& line, const std::vector<Experiment>& experiments);

/// Reads a table with checksums. Throws IoError with file and line if a checksum is not that of its row, and
/// if the file cannot be read, the header is another one, a line is not a row of one of the experiments, a
/// lap is duplicate, or its seed is not lap_seed(seed0, ...). With `accept_truncated` an incomplete last line
/// (the program was killed while it wrote) is ignored, and so is a missing header of an otherwise empty file.
std::vector<LapRow> read_rows(const std::filesystem::path& file, const std::vector<Experiment>& experiments,
                              bool accept_truncated, std::uint64_t seed0);

}  // namespace slalom::evaluation
