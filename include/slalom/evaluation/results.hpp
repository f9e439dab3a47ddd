#pragma once

#include "slalom/evaluation/lap_table.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

/// Laps from which a bootstrap interval says something: that of fewer is too narrow, of one without width.
inline constexpr int fewest_laps = 5;

/// Statistics of the laps of one experiment. Rates are fractions. Every lap counts, whether it finished or
/// not; without laps all values are 0.
struct ExperimentResult {
  int experiment = 0;                                   ///< index
  int laps = 0, finished = 0, timeouts = 0;             ///< numbers of laps
  int collisions = 0;                                   ///< as the protocol counts them
  double ms_mean = 0;                                   ///< MS: mean over laps of the mean sequence cost
  Interval ms_ci{};                                     ///< bootstrap over laps; see fewest_laps
  double state_cost_mean = 0, collision_cost_mean = 0;  ///< over laps
  std::optional<double> collision_rate{};       ///< collisions / (obstacles x laps); none without obstacles
  std::optional<Interval> collision_rate_ci{};  ///< Wilson
  std::optional<Interval> collision_rate_bootstrap_ci{};  ///< over laps
  double success_rate = 0;                                ///< finished laps without a collision
  Interval success_rate_ci{};                             ///< Wilson
  double time_mean = 0;                                   ///< s, of finished laps; NaN without any
  Interval time_ci{};                                     ///< bootstrap over finished laps; see fewest_laps
  /// Wall-clock times, ms: means over laps of each one's mean, median and 99th percentile, and the longest.
  double solve_mean = 0, solve_p50 = 0, solve_p99 = 0, solve_max = 0;  ///< mean, median, 99 %, longest
  /// Sums over laps; errors are root mean squares over all detections, `update_p99` (ms) the mean over the
  /// laps. None without `world.tracking`.
  std::optional<TrackingFigures> tracking{};
  /// Sums over laps; `duration` (s) is the mean over all opponents overtaken. None without `world.opponents`.
  std::optional<OvertakingFigures> overtaking{};
};

/// The laps of two experiments, a and b. With equal seeds lap k has the same obstacles: the laps are paired.
struct Comparison {
  bool paired = true;              ///< whether the same seeds are compared
  int laps = 0;                    ///< pairs, or laps of both
  double ms_difference = 0;        ///< mean MS of a - b; NaN without laps
  std::optional<double> ms_p = 1;  ///< none where MS is not tested
  double time_difference = 0;      ///< s, mean time of a - b, of pairs that both finish, or of finished laps
  double time_p = 1;               ///< p value of the times
  int only_a_succeeds = 0, only_b_succeeds = 0;  ///< pairs in which only one of them succeeds
  double success_p = 1, collisions_p = 1;        ///< p value of the success, p value of the collisions
};

/// Compares laps of `a` and `b`, the numbers of whose obstacles are given for all laps together. Paired laps,
/// those of the same number: Wilcoxon's signed-rank test, McNemar's for success. Others: bootstrap of the
/// difference of means, Fisher's exact test for success and collisions.
Comparison compare_laps(const std::vector<const LapRow*>& a, std::int64_t obstacles_a,
                        const std::vector<const LapRow*>& b, std::int64_t obstacles_b, bool paired);

/// A comparison with the indices of its experiments.
struct PairedComparison : Comparison {
  int a = 0, b = 0;  ///< index of the first, index of the second
};

/// The laps of an experiment, in their order.
std::vector<const LapRow*> rows_of(const std::vector<LapRow>& rows, int experiment);

/// One result per experiment, in their order. Rows may come in any order.
std::vector<ExperimentResult> summarise(const std::vector<LapRow>& rows,
                                        const std::vector<Experiment>& experiments);

/// Compares every pair of experiments of the same scenario and number of obstacles.
std::vector<PairedComparison> compare_pairs(const std::vector<LapRow>& rows,
                                            const std::vector<Experiment>& experiments);

}  // namespace slalom::evaluation
