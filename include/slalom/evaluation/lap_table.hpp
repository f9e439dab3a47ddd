#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slalom/evaluation/lap_runner.hpp"

namespace slalom::evaluation {

/// What is compared: a method with options set otherwise than in the configuration, in a scenario.
struct Experiment {
  std::string method;
  std::vector<std::pair<std::string, std::string>> set;  ///< section.option and value, as text
  std::string scenario;                                  ///< "pt" (no obstacles) or "oa"
  int obstacles = 0;                                     ///< a lap
  int laps = 0;

  /// The options set, "svg_mppi.variance=0.05 vehicle.dead_time=0"; empty without any.
  std::string set_text() const;
  /// Names it in tables: method and options set.
  std::string label() const;
};

/// A row of `laps.csv`: one lap of one experiment. Columns whose names contain `calculation_time`, or begin
/// with `solve_`, `deadline_` or `wall_`, hold wall-clock times (ms, but `wall_time` s); all others repeat
/// exactly.
struct LapRow {
  int experiment = 0;
  int lap = 0;
  std::uint64_t seed = 0;
  bool success = false;  ///< finished without contact
  int collisions = 0;    ///< contacts as the evaluation counts them
  bool timeout = false;
  bool finished = false;
  double state_cost = 0, collision_cost = 0, input_error = 0;
  double mean_calculation_time = 0, max_calculation_time = 0, min_calculation_time = 0;  ///< ms
  double lap_time = 0;                                                                   ///< s
  int steps = 0;
  int collided_bodies = 0;  ///< different bodies touched, all walls as one
  bool wall = false;
  int impassable = 0;            ///< obstacles that no car of this width could have passed
  double minimum_clearance = 0;  ///< m
  double mean_speed = 0;         ///< m/s
  double mean_path_distance = 0, max_path_distance = 0;  ///< m
  double mean_variance = 0, mean_effective_samples = 0;
  double ms_published_model = 0, ms_driven = 0;
  int blocked_steps = 0;                ///< control steps in which every plan collided
  int degenerate_steps = 0;             ///< control steps without usable weights
  std::string contact_points;           ///< where bodies were first touched: "x:y" in m, separated by spaces
  double solve_p50 = 0, solve_p99 = 0;  ///< ms
  double wall_time = 0;                 ///< s the lap took to compute

  double mean_sequence_cost() const { return state_cost + collision_cost; }
};

/// The row of a lap that has ended.
LapRow make_row(int experiment, int lap, const LapResult& result, double wall_time);

/// The header of laps.csv: `method,scenario,set,lap`, the columns of the published logs, then ours.
std::string csv_header();
/// A row as it stands in laps.csv, without line end; numbers so that they read back to the same bits.
std::string csv_line(const LapRow& row, const std::vector<Experiment>& experiments);

/// A row from such a line. Throws std::invalid_argument naming the column, its value and the rule.
LapRow parse_line(const std::string& line, const std::vector<Experiment>& experiments);

/// Reads rows. Throws IoError naming file and line where a line is not a row of one of the experiments, a lap
/// stands twice, or its seed is not that of the lap where `seed0` is given. With `forgive_last`, a last line
/// that is not complete (a run was killed while it wrote) is passed over, and so is a file without a header.
std::vector<LapRow> read_rows(const std::filesystem::path& file, const std::vector<Experiment>& experiments,
                              bool forgive_last, std::optional<std::uint64_t> seed0 = {});

}  // namespace slalom::evaluation
