#pragma once

#include "slalom/evaluation/lap_table.hpp"
#include "slalom/evaluation/statistics.hpp"

/// Comparison of laps with a log that another program has written.
namespace slalom::evaluation {

/// A log of laps: CSV with at least the columns `success`, `collision`, `state_cost` and `collision_cost` and
/// one row per lap, as written by the program of Honda et al. (ICRA 2024).
struct LapLog {
  std::string file{};                                     ///< path
  int laps = 0, successes = 0, timeouts = 0;              ///< numbers of laps
  std::int64_t collisions = 0;                            ///< collisions of all laps
  std::vector<double> ms{};                               ///< per lap: state_cost + collision_cost
  std::vector<double> seeds{};                            ///< per lap; empty if the log has no column `seed`
  std::vector<double> lap_collisions{};                   ///< per lap; empty if only their sum is known
  std::optional<double> solve_ms_mean{}, solve_ms_max{};  ///< ms, where the log has `*_calculation_time`
};

/// Reads a log of at most 64 MiB, 64 KiB a line and 1,000,000 laps. Throws IoError with file, line and column
/// if it is larger, is not a regular file or cannot be read, if a column is missing or given twice, and if a
/// value is not a finite number of at most 1e12 in magnitude.
LapLog read_lap_log(const std::filesystem::path& file);

/// Whether measured laps agree with a log.
enum class Agreement {
  outside,    ///< a test finds a difference at the 5 % level
  inside,     ///< no test does, and there are enough laps to show a difference that matters
  undecided,  ///< no test does, but the laps are too few or too scattered to decide
};

/// Measured laps compared with a log. Laps among obstacles are paired if the log has a lap with the seed of
/// each measured lap, since the seed places the obstacles: only these laps of the log count, and the tests
/// are those of paired laps.
struct LogComparison {
  int our_laps = 0;        ///< number of measured laps
  int laps = 0;            ///< number of laps of the log that they are compared with
  bool paired = false;     ///< whether the laps are paired by seed
  double ms_mean = 0;      ///< MS of the whole log
  Interval ms_ci{};        ///< interval of the log's MS, bootstrap over laps
  double ms_ratio = 0;     ///< measured / log
  Interval ms_ratio_ci{};  ///< 1 + the bootstrapped difference of means / mean of the log
  /// Wilcoxon's signed-rank test; not paired: two-sample bootstrap, or permutation test below `enough_laps`.
  double ms_p = 1;
  std::optional<double> collision_rate{};        ///< collision rate of the whole log; none without obstacles
  std::optional<Interval> collision_rate_ci{};   ///< interval of the log's collision rate, Wilson
  std::optional<Interval> rate_difference_ci{};  ///< measured - log, Newcombe, which ignores the pairs
  std::optional<double> collision_p{};  ///< Wilcoxon's signed-rank test; not paired: Fisher's exact test

  static constexpr int enough_laps = 10;  ///< laps from which on the bootstrap is used and MS can be inside
  /// `inside` needs confidence intervals within this: a fraction of MS, and a collision rate.
  static constexpr double ms_half_width = 0.5, rate_half_width = 0.1;  ///< fraction of MS, collision rate

  Agreement ms_agreement() const;         ///< agreement in MS
  Agreement collision_agreement() const;  ///< agreement in the collision rate; inside without obstacles
  Agreement agreement() const;            ///< the worse of both
};

/// `rows` are the laps of one experiment with `obstacles` per lap, as in the log.
LogComparison compare_with_log(const std::vector<LapRow>& rows, int obstacles, const LapLog& log);

}  // namespace slalom::evaluation
