#pragma once

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
  int met = 0, overtaken = 0, not_overtaken = 0;
  double duration = 0;  ///< s
  int contacts = 0, caused = 0, side_changes = 0;
};
/// Calls `visit(field, Figure)` for every figure in the order of tables.
template <class Figures, class Visit>
requires std::derived_from<std::remove_const_t<Figures>, OvertakingFigures>
void visit_figures(Figures& f, Visit&& visit) {
  visit(f.met, Figure{"opponents_met", "", "encounters with opponents"});
  visit(f.overtaken, Figure{"overtaken", "", "those that ended with the opponent behind"});
  visit(f.not_overtaken,
        Figure{"not_overtaken", "", "those in which two times around the course were not enough"});
  visit(f.duration,
        Figure{"overtaking_time", "s", "mean time until an opponent was overtaken, 0 without any"});
  visit(f.contacts, Figure{"opponent_contacts", "", "contacts with opponents"});
  visit(f.caused, Figure{"contacts_caused", "", "those of them at which the car is at fault"});
  visit(f.side_changes, Figure{"side_changes", "", "Encounter::side_changes of all encounters"});
}

/// A row of `laps.csv`: one lap of one experiment.
struct LapRow : LapFigures {
  int experiment = 0;                                                  ///< index into the experiments
  int lap = 0;                                                         ///< from 0
  double solve_mean = 0, solve_p50 = 0, solve_p99 = 0, solve_max = 0;  ///< ms
  int blocked_steps = 0, degenerate_steps = 0;
  std::string collision_points;
  double wall_time = 0;          ///< s
  TrackingFigures tracking;      ///< columns only in evaluations with `world.tracking`
  OvertakingFigures overtaking;  ///< columns only in evaluations with `world.opponents`
};
/// Calls `visit(field, Figure)` for every figure of a row in the order of tables, but for those of tracking
/// and overtaking.
template <class Row, class Visit>
void visit_row(Row& r, Visit&& visit) {
  visit_figures(r, visit);
  visit(r.blocked_steps, Figure{"blocked_steps", "", "control steps in which every plan collided"});
  visit(r.degenerate_steps, Figure{"degenerate_steps", "", "control steps without usable weights"});
  visit(r.collision_points,
        Figure{"collision_points", "m", "\"x:y\", the car's position at its first collision with each body"});
  visit(r.solve_mean, Figure{"solve_mean", "ms", "mean time of a solve", true});
  visit(r.solve_p50, Figure{"solve_p50", "ms", "median of the time of a solve", true});
  visit(r.solve_p99, Figure{"solve_p99", "ms", "99th percentile of the time of a solve", true});
  visit(r.solve_max, Figure{"solve_max", "ms", "longest solve", true});
  visit(r.wall_time, Figure{"wall_time", "s", "time to compute the lap", true});
}

/// The row of a lap that has ended.
LapRow make_row(int experiment, int lap, const LapResult& result, double wall_time);

/// Whether an obstacle stood where the car starts (its centre of gravity is at `start`): the first collision
/// is within 0.05 m of the start. No driver avoids it.
bool began_in_contact(const LapRow& row, const maps::Pose& start);

/// Whether two rows of a lap agree in all columns but wall-clock times.
bool same_lap(const LapRow& a, const LapRow& b, const std::vector<Experiment>& experiments);

/// The header of laps.csv: `method,scenario,set,lap`, the figures of LapRow, if one of the experiments
/// tracks, those of TrackingFigures, and if one has opponents, those of OvertakingFigures.
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
