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
  std::int64_t collisions = 0;
  std::vector<double> ms;                             ///< a lap: state_cost + collision_cost
  std::optional<double> solve_ms_mean, solve_ms_max;  ///< where the log has `*_calculation_time`
};

/// Throws IoError naming file, line and column where the file cannot be read or a lap makes no sense.
LapLog read_lap_log(const std::filesystem::path& file);

/// What laps of ours say beside those of a log.
enum class Agreement {
  outside,    ///< at 5 % a test tells the two apart
  inside,     ///< none does, and the laps would show a difference that matters
  undecided,  ///< none does, but the laps are too few or too scattered to say
};

/// Ours beside theirs.
struct LogComparison {
  int our_laps = 0, laps = 0;
  double ms_mean = 0;                          ///< theirs
  Interval ms_ci;                              ///< theirs, bootstrap over laps
  double ms_ratio = 0;                         ///< ours / theirs
  Interval ms_ratio_ci;                        ///< 1 + the bootstrapped difference of means / their mean
  double ms_p = 1;                             ///< two-sample bootstrap; permutation test below `enough_laps`
  std::optional<double> collision_rate;        ///< theirs; none without obstacles
  std::optional<Interval> collision_rate_ci;   ///< theirs, Wilson
  std::optional<Interval> rate_difference_ci;  ///< ours - theirs, Newcombe
  std::optional<double> collision_p;           ///< Fisher's exact test

  static constexpr int enough_laps = 10;
  /// "Inside" takes intervals that are no wider than this to each side: half of their MS, ten points of their
  /// collision rate.
  static constexpr double telling_ratio = 0.5, telling_rate = 0.1;  ///< of MS, of the rate

  Agreement ms_agreement() const;
  Agreement collision_agreement() const;  ///< inside without obstacles
  Agreement agreement() const;
};

/// `rows` are the laps of one experiment with `obstacles` a lap, which both drove.
LogComparison compare_with_log(const std::vector<LapRow>& rows, int obstacles, const LapLog& log);

}  // namespace slalom::evaluation
