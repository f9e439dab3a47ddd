#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "slalom/evaluation/lap_table.hpp"
#include "slalom/evaluation/statistics.hpp"

/// Laps that others drove and logged, and whether ours could be more of the same.
namespace slalom::evaluation {

/// A log of laps: CSV with at least the columns `success`, `collision`, `state_cost` and `collision_cost`,
/// one row a lap, as the program of Honda et al. (ICRA 2024) writes it.
struct LapLog {
  std::string file;
  int laps = 0, successes = 0, timeouts = 0;
  std::int64_t contacts = 0;
  std::vector<double> ms;                             ///< a lap: state_cost + collision_cost
  std::optional<double> solve_ms_mean, solve_ms_max;  ///< where the log has `*_calculation_time`
};

/// Throws IoError naming file, line and column where the file cannot be read or a lap makes no sense.
LapLog read_lap_log(const std::filesystem::path& file);

/// Ours beside theirs. "Inside" says that at 5 % no test tells the two apart.
struct LogComparison {
  double ms_mean = 0;                    ///< theirs
  Interval ms_ci;                        ///< theirs, bootstrap over laps
  double ms_ratio = 0;                   ///< ours / theirs
  double ms_p = 1;                       ///< two-sample bootstrap; NaN with fewer than two laps in either
  std::optional<double> collision_rate;  ///< theirs; none without obstacles
  std::optional<Interval> collision_rate_ci;  ///< theirs, Wilson
  std::optional<double> contacts_p;           ///< Fisher's exact test

  bool ms_inside() const { return !(ms_p < 0.05); }
  bool contacts_inside() const { return !contacts_p || !(*contacts_p < 0.05); }
  bool inside() const { return ms_inside() && contacts_inside(); }
};

/// `rows` are the laps of one experiment with `obstacles` a lap, which both drove.
LogComparison compare_with_log(const std::vector<LapRow>& rows, int obstacles, const LapLog& log);

}  // namespace slalom::evaluation
