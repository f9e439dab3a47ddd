#pragma once

#include <optional>
#include <vector>

#include "slalom/evaluation/lap_table.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

/// Laps from which a bootstrap interval says something: that of fewer is too narrow, and that of one has no
/// width.
inline constexpr int fewest_laps = 5;

/// Statistics of the laps of one experiment. Rates are fractions. Every lap counts, whether it finished or
/// not; without laps all values are 0.
struct ExperimentResult {
  int experiment = 0;                                   ///< index
  int laps = 0, finished = 0, timeouts = 0;             ///< numbers of laps
  int collisions = 0;                                   ///< as the protocol counts them
  int impassable = 0;                                   ///< obstacles of all laps in impassable_obstacles
  double ms_mean = 0;                                   ///< MS: mean over laps of the mean sequence cost
  Interval ms_ci;                                       ///< bootstrap over laps; see fewest_laps
  double state_cost_mean = 0, collision_cost_mean = 0;  ///< over laps
  std::optional<double> collision_rate;       ///< collisions / (obstacles x laps); none without obstacles
  std::optional<Interval> collision_rate_ci;  ///< Wilson
  std::optional<Interval> collision_rate_bootstrap_ci;  ///< over laps
  double success_rate = 0;                              ///< finished laps without a collision
  Interval success_rate_ci;                             ///< Wilson
  double lap_time_mean = 0;                             ///< s, of finished laps; NaN without any
  double solve_ms_mean = 0;  ///< ms, wall-clock, mean over the laps of each lap's mean
  double solve_ms_p50 = 0;   ///< ms, mean over the laps of each lap's median
  double solve_ms_p99 = 0;   ///< ms, mean over the laps of each lap's 99th percentile
  double solve_ms_max = 0;   ///< ms, largest of all laps
  /// Sums over laps; errors are root mean squares over all detections, `update_p99` (ms) the mean over the
  /// laps. None without `world.tracking`.
  std::optional<TrackingFigures> tracking;
  /// Sums over laps; `duration` (s) is the mean over all opponents overtaken. None without `world.opponents`.
  std::optional<OvertakingFigures> overtaking;
};

/// Two experiments over the same seeds.
struct PairedComparison {
  int a = 0, b = 0;                              ///< indices of the experiments
  int laps = 0;                                  ///< pairs
  double ms_difference = 0;                      ///< mean of a - b; NaN without pairs
  double ms_p = 1;                               ///< Wilcoxon signed-rank test
  int only_a_succeeds = 0, only_b_succeeds = 0;  ///< laps in which only one of them succeeds
  double success_p = 1;                          ///< McNemar test
  double collision_p = 1;                        ///< Wilcoxon signed-rank test of the collisions per lap
};

/// One result per experiment, in their order. Rows may come in any order.
std::vector<ExperimentResult> summarise(const std::vector<LapRow>& rows,
                                        const std::vector<Experiment>& experiments);

/// Compares every pair of experiments of the same scenario and number of obstacles.
std::vector<PairedComparison> compare_pairs(const std::vector<LapRow>& rows,
                                            const std::vector<Experiment>& experiments);

}  // namespace slalom::evaluation
