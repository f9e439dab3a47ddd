#pragma once

#include <cstdint>
#include <span>

/// Statistics of laps: intervals and paired tests. All are deterministic.
namespace slalom::evaluation {

/// A two-sided interval, 95 % unless said otherwise.
struct Interval {
  double low = 0;   ///< lower end
  double high = 0;  ///< upper end
};

/// Wilson's score interval for a rate of `successes` out of `trials` (E. B. Wilson, JASA 22, 1927). [0, 1]
/// without trials; successes beyond the trials count as all of them.
Interval wilson_interval(std::int64_t successes, std::int64_t trials, double z = 1.959963984540054);

/// Exact interval for the mean of a Poisson distribution of which `count` was drawn (Garwood, Biometrika 28,
/// 1936), for instance of contacts on a distance. A count below 0 is taken as 0.
Interval poisson_interval(std::int64_t count);

double mean(std::span<const double> values);  ///< NaN without values

/// A percentile of values in any order by the nearest rank: the smallest of them that at least a share (0 to
/// 1) of all do not exceed. NaN without values.
double percentile(std::span<const double> values, double share);
/// The same.
double percentile(std::span<const float> values, double share);

/// Percentile bootstrap of the mean (Efron & Tibshirani 1993, chapter 13). NaN without values or resamples.
Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed = 1, int resamples = 10000);

/// Percentile bootstrap of sum(numerator) / sum(denominator) over paired entries, for instance collisions
/// over obstacles per lap: laps are resampled as a whole. Resamples whose denominators sum to 0
/// are left out. NaN where all denominators sum to 0 and where no resample is left.
Interval bootstrap_ratio(std::span<const double> numerator, std::span<const double> denominator,
                         std::uint64_t seed = 1, int resamples = 10000);

/// Two-sided p value of equal means of two independent samples: bootstrap under the null hypothesis, both
/// samples shifted to the common mean, with Welch's t as statistic (Efron & Tibshirani 1993, algorithm 16.2).
/// 1 where both are constant and equal; NaN with fewer than 2 values in either.
double bootstrap_difference_p(std::span<const double> a, std::span<const double> b, std::uint64_t seed = 1,
                              int resamples = 10000);

/// Two-sided p value of two independent samples being draws of the same distribution: permutation test with
/// the difference of means as statistic (Fisher 1935; `resamples` random permutations, so no p below 1 /
/// (resamples + 1)). Valid for any number of values, but without power for very few: with 2 and 2 no p is
/// below 1/3. NaN without values in either.
double permutation_difference_p(std::span<const double> a, std::span<const double> b, std::uint64_t seed = 1,
                                int resamples = 10000);

/// Percentile bootstrap of mean(a) - mean(b) of two independent samples. NaN without values in either.
Interval bootstrap_difference(std::span<const double> a, std::span<const double> b, std::uint64_t seed = 1,
                              int resamples = 10000);

/// Interval of the difference of two independent rates, a - b, from their Wilson intervals (Newcombe,
/// "Interval Estimation for the Difference between Independent Proportions", 1998, method 10). Successes
/// beyond the trials count as all of them.
Interval rate_difference_interval(std::int64_t successes_a, std::int64_t trials_a, std::int64_t successes_b,
                                  std::int64_t trials_b);

/// Exact two-sided McNemar test of paired yes/no outcomes: `only_a`, `only_b` count the pairs in which only
/// one says yes (McNemar 1947; binomial, so valid for small counts too).
double mcnemar_p(std::int64_t only_a, std::int64_t only_b);

/// Fisher's exact two-sided test of equal rates in two independent samples (Fisher 1935): the probability of
/// all tables with these margins that are no more likely than the observed one. Successes beyond the trials
/// count as all of them; 1 where either has no trials.
double fisher_p(std::int64_t successes_a, std::int64_t trials_a, std::int64_t successes_b,
                std::int64_t trials_b);

/// Two-sided Wilcoxon signed-rank test of paired differences (Wilcoxon 1945): zeros are dropped, ties share
/// their mean rank; exact without ties up to 50 pairs, else the normal approximation with tie and continuity
/// correction. 1 without non-zero differences.
double wilcoxon_p(std::span<const double> differences);

}  // namespace slalom::evaluation
