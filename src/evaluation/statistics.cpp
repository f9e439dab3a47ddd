#include "slalom/evaluation/statistics.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/random.hpp"

namespace slalom::evaluation {

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::size_t draw_index(RandomStream& random, std::size_t count) {
  return std::min(count - 1, saturate_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}

/// The 2.5 and 97.5 percentiles, by linear interpolation. NaN without values.
Interval percentile_interval(std::vector<double>& values) {
  if (values.empty()) return {not_a_number, not_a_number};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double position = share * static_cast<double>(values.size() - 1);
    const auto i = saturate_cast<std::size_t>(position);
    const double fraction = position - static_cast<double>(i);
    return i + 1 < values.size() ? values[i] * (1 - fraction) + values[i + 1] * fraction : values[i];
  };
  return {at(0.025), at(0.975)};
}

template <class Number>
double nearest_rank(std::span<const Number> values, double share) {
  if (values.empty()) return not_a_number;
  // A product that is whole but for rounding is that rank.
  const double count = static_cast<double>(values.size()), rank = std::ceil(share * count - 1e-9);
  std::vector<Number> ranked(values.begin(), values.end());
  const auto at = ranked.begin() + saturate_cast<std::ptrdiff_t>(std::clamp(rank, 1.0, count)) - 1;
  std::nth_element(ranked.begin(), at, ranked.end());
  return static_cast<double>(*at);
}

struct Moments {
  double mean = 0;
  double variance = 0;  ///< variance of the mean
};
Moments moments(std::span<const double> values) {
  const double m = mean(values);
  double squares = 0;
  for (const double v : values) squares += (v - m) * (v - m);
  const double n = static_cast<double>(values.size());
  return {m, squares / (n - 1) / n};
}

double welch(const Moments& a, const Moments& b) {
  const double spread = std::sqrt(a.variance + b.variance), difference = std::abs(a.mean - b.mean);
  if (spread > 0) return difference / spread;
  return difference > 0 ? std::numeric_limits<double>::infinity() : 0;
}

double normal_tail(double z) {
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// The mean, at most `most`, of the Poisson distribution with draws up to `count` with this probability.
double poisson_mean(std::int64_t count, double probability, double most) {
  const double log_factorial = std::lgamma(static_cast<double>(count) + 1);
  double low = 0, high = most;
  for (int halving = 0; halving < 80; ++halving) {
    const double middle = 0.5 * (low + high);
    double term = std::exp(static_cast<double>(count) * std::log(middle) - middle - log_factorial),
           sum = term;
    for (std::int64_t i = count; i > 0 && term > 0; --i) sum += term *= static_cast<double>(i) / middle;
    (sum > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Interval wilson_interval(std::int64_t successes, std::int64_t trials, double z) {
  if (trials <= 0) return {0, 1};
  const double n = static_cast<double>(trials),
               p = static_cast<double>(std::clamp<std::int64_t>(successes, 0, trials)) / n;
  const double z2 = z * z, centre = p + z2 / (2 * n),
               spread = z * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {std::max(0.0, (centre - spread) / (1 + z2 / n)), std::min(1.0, (centre + spread) / (1 + z2 / n))};
}

Interval poisson_interval(std::int64_t count) {
  count = std::max<std::int64_t>(count, 0);
  const auto n = static_cast<double>(count);
  const double most = n + 10 * std::sqrt(n + 1) + 10;
  return {count == 0 ? 0 : poisson_mean(count - 1, 0.975, most), poisson_mean(count, 0.025, most)};
}

double mean(std::span<const double> values) {
  if (values.empty()) return not_a_number;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double percentile(std::span<const double> values, double share) {
  return nearest_rank(values, share);
}

double percentile(std::span<const float> values, double share) {
  return nearest_rank(values, share);
}

Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed, int resamples) {
  const std::vector<double> ones(values.size(), 1.0);
  return bootstrap_ratio(values, ones, seed, resamples);
}

Interval bootstrap_ratio(std::span<const double> numerator, std::span<const double> denominator,
                         std::uint64_t seed, int resamples) {
  const std::size_t n = std::min(numerator.size(), denominator.size());
  if (n == 0 || std::accumulate(denominator.begin(), denominator.end(), 0.0) == 0)
    return {not_a_number, not_a_number};
  RandomStream random({seed, 0});
  std::vector<double> ratios;
  ratios.reserve(static_cast<std::size_t>(resamples));
  for (int r = 0; r < resamples; ++r) {
    double above = 0, below = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = draw_index(random, n);
      above += numerator[k];
      below += denominator[k];
    }
    if (below != 0) ratios.push_back(above / below);
  }
  return percentile_interval(ratios);
}

double bootstrap_difference_p(std::span<const double> a, std::span<const double> b, std::uint64_t seed,
                              int resamples) {
  if (a.size() < 2 || b.size() < 2) return not_a_number;
  const double observed = welch(moments(a), moments(b));
  const double common = (mean(a) * static_cast<double>(a.size()) + mean(b) * static_cast<double>(b.size())) /
                        static_cast<double>(a.size() + b.size());
  RandomStream random({seed, 1});
  std::vector<double> x(a.size()), y(b.size());
  const auto resample = [&](std::span<const double> from, double from_mean, std::vector<double>& to) {
    for (double& v : to) v = from[draw_index(random, from.size())] - from_mean + common;
  };
  int as_extreme = 0;
  for (int r = 0; r < resamples; ++r) {
    resample(a, mean(a), x);
    resample(b, mean(b), y);
    as_extreme += welch(moments(x), moments(y)) >= observed;
  }
  return (as_extreme + 1.0) / (resamples + 1.0);
}

double permutation_difference_p(std::span<const double> a, std::span<const double> b, std::uint64_t seed,
                                int resamples) {
  if (a.empty() || b.empty()) return not_a_number;
  std::vector<double> all(a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  const double sum = std::accumulate(all.begin(), all.end(), 0.0);
  const double na = static_cast<double>(a.size()), nb = static_cast<double>(b.size());
  const auto difference = [&](double sum_a) { return std::abs(sum_a / na - (sum - sum_a) / nb); };
  // Arrangements equally extreme must count in spite of rounding.
  const double observed = difference(std::accumulate(a.begin(), a.end(), 0.0)) * (1 - 1e-9) - 1e-12;
  RandomStream random({seed, 2});
  int as_extreme = 0;
  for (int r = 0; r < resamples; ++r) {
    double sum_a = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      std::swap(all[i], all[i + draw_index(random, all.size() - i)]);
      sum_a += all[i];
    }
    as_extreme += difference(sum_a) >= observed;
  }
  return (as_extreme + 1.0) / (resamples + 1.0);
}

Interval bootstrap_difference(std::span<const double> a, std::span<const double> b, std::uint64_t seed,
                              int resamples) {
  if (a.empty() || b.empty()) return {not_a_number, not_a_number};
  RandomStream random({seed, 3});
  const auto drawn_mean = [&](std::span<const double> from) {
    double sum = 0;
    for (std::size_t i = 0; i < from.size(); ++i) sum += from[draw_index(random, from.size())];
    return sum / static_cast<double>(from.size());
  };
  std::vector<double> differences(static_cast<std::size_t>(resamples));
  for (double& difference : differences) {
    const double of_a = drawn_mean(a);
    difference = of_a - drawn_mean(b);
  }
  return percentile_interval(differences);
}

Interval rate_difference_interval(std::int64_t successes_a, std::int64_t trials_a, std::int64_t successes_b,
                                  std::int64_t trials_b) {
  const auto rate = [](std::int64_t successes, std::int64_t trials) {
    return trials > 0 ? static_cast<double>(std::clamp<std::int64_t>(successes, 0, trials)) /
                            static_cast<double>(trials)
                      : 0.5;
  };
  const double a = rate(successes_a, trials_a), b = rate(successes_b, trials_b);
  const Interval of_a = wilson_interval(successes_a, trials_a), of_b = wilson_interval(successes_b, trials_b);
  return {a - b - std::hypot(a - of_a.low, of_b.high - b), a - b + std::hypot(of_a.high - a, b - of_b.low)};
}

double mcnemar_p(std::int64_t only_a, std::int64_t only_b) {
  const std::int64_t n = only_a + only_b, few = std::min(only_a, only_b);
  if (n == 0) return 1;
  double tail = 0;
  for (std::int64_t k = 0; k <= few; ++k) {
    const double nd = static_cast<double>(n), kd = static_cast<double>(k);
    tail +=
        std::exp(std::lgamma(nd + 1) - std::lgamma(kd + 1) - std::lgamma(nd - kd + 1) - nd * std::log(2.0));
  }
  return std::min(1.0, 2 * tail);
}

double fisher_p(std::int64_t successes_a, std::int64_t trials_a, std::int64_t successes_b,
                std::int64_t trials_b) {
  if (trials_a <= 0 || trials_b <= 0) return 1;
  const std::int64_t a = std::clamp<std::int64_t>(successes_a, 0, trials_a),
                     b = std::clamp<std::int64_t>(successes_b, 0, trials_b), successes = a + b;
  const auto log_choose = [](std::int64_t n, std::int64_t k) {
    const auto factorial = [](std::int64_t m) { return std::lgamma(static_cast<double>(m) + 1); };
    return factorial(n) - factorial(k) - factorial(n - k);
  };
  const double all = log_choose(trials_a + trials_b, successes);
  const auto probability = [&](std::int64_t k) {
    return std::exp(log_choose(trials_a, k) + log_choose(trials_b, successes - k) - all);
  };
  // Tables as likely as the observed one must count in spite of rounding.
  const double seen = probability(a) * (1 + 1e-7);
  double p = 0;
  for (std::int64_t k = std::max<std::int64_t>(0, successes - trials_b); k <= std::min(successes, trials_a);
       ++k)
    p += probability(k) <= seen ? probability(k) : 0;
  return std::min(1.0, p);
}

double wilcoxon_p(std::span<const double> differences) {
  std::vector<double> d;
  for (const double v : differences) {
    if (v != 0) d.push_back(v);
  }
  const std::size_t n = d.size();
  if (n == 0) return 1;
  std::sort(d.begin(), d.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  double positive = 0, tie_correction = 0;
  bool ties = false;
  for (std::size_t i = 0; i < n;) {
    std::size_t j = i;
    while (j < n && std::abs(d[j]) == std::abs(d[i])) ++j;
    const double count = static_cast<double>(j - i), rank = 0.5 * static_cast<double>(i + 1 + j);
    ties |= j - i > 1;
    tie_correction += count * count * count - count;
    for (std::size_t k = i; k < j; ++k) positive += d[k] > 0 ? rank : 0;
    i = j;
  }
  const double nd = static_cast<double>(n), total = nd * (nd + 1) / 2,
               few = std::min(positive, total - positive);
  if (!ties && n <= 50) {
    // The number of the 2^n choices of signs that give each rank sum.
    std::vector<double> ways(saturate_cast<std::size_t>(total) + 1);
    ways[0] = 1;
    for (std::size_t rank = 1; rank <= n; ++rank) {
      for (std::size_t sum = ways.size() - 1; sum >= rank; --sum) ways[sum] += ways[sum - rank];
    }
    double tail = 0;
    for (std::size_t sum = 0; sum <= saturate_cast<std::size_t>(few); ++sum) tail += ways[sum];
    return std::min(1.0, 2 * std::ldexp(tail, -static_cast<int>(n)));
  }
  const double variance = nd * (nd + 1) * (2 * nd + 1) / 24 - tie_correction / 48;
  if (variance <= 0) return 1;
  const double z = std::max(0.0, std::abs(positive - total / 2) - 0.5) / std::sqrt(variance);
  return std::min(1.0, 2 * normal_tail(z));
}

}  // namespace slalom::evaluation
