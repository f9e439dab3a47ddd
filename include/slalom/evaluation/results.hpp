#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slalom/evaluation/lap_table.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

/// What the laps of one experiment say. Rates are fractions; every lap counts, whether it finished or not.
struct ExperimentResult {
  int experiment = 0;
  int laps = 0, finished = 0, timeouts = 0;
  int collisions = 0;  ///< contacts as the evaluation counts them
  int impassable = 0;  ///< obstacles, of all laps, that no car could have passed
  double ms_mean = 0;  ///< MS: mean over laps of the mean sequence cost
  Interval ms_ci;      ///< bootstrap over laps
  double state_cost_mean = 0, collision_cost_mean = 0;
  std::optional<double> collision_rate;       ///< contacts / (obstacles x laps); none without obstacles
  std::optional<Interval> collision_rate_ci;  ///< Wilson
  std::optional<Interval> collision_rate_bootstrap_ci;  ///< over laps
  double success_rate = 0;                              ///< finished laps without contact
  Interval success_rate_ci;                             ///< Wilson
  double lap_time_mean = 0;                             ///< s, of finished laps; NaN without any
  double solve_ms_mean = 0, solve_ms_p50 = 0, solve_ms_p99 = 0, solve_ms_max = 0;
};

/// Two experiments over the same seeds.
struct PairedComparison {
  int a = 0, b = 0;          ///< experiments
  int laps = 0;              ///< pairs
  double ms_difference = 0;  ///< mean of a - b
  double ms_p = 1;           ///< Wilcoxon signed-rank
  int only_a_succeeds = 0, only_b_succeeds = 0;
  double success_p = 1;    ///< McNemar
  double collision_p = 1;  ///< Wilcoxon signed-rank over contacts a lap
};

/// One result per experiment, in their order. Rows may come in any order.
std::vector<ExperimentResult> summarise(const std::vector<LapRow>& rows,
                                        const std::vector<Experiment>& experiments);

/// Every pair of experiments of the same scenario.
std::vector<PairedComparison> compare_pairs(const std::vector<LapRow>& rows,
                                            const std::vector<Experiment>& experiments);

}  // namespace slalom::evaluation
