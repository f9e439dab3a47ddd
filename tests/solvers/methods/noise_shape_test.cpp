#include "solvers/sampling/noise_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "slalom/core/random.hpp"

namespace slalom::detail {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Samples of shaped noise, all tiles at once.
SequenceBatch shaped(NoiseShape& shape, int steps, int inputs, int samples, std::uint64_t seed = 3) {
  SequenceBatch z(steps, inputs, samples);
  fill_normal(z, 0, z.stride(), {seed, 5});
  shape.apply(z, {0, z.stride()});
  return z;
}

/// Mean of a[k] b[k] over the samples.
double moment(const SequenceBatch& z, int s, int t, int input) {
  double sum = 0;
  for (int k = 0; k < z.samples(); ++k)
    sum += static_cast<double>(z.at(s, input, k)) * static_cast<double>(z.at(t, input, k));
  return sum / z.samples();
}

TEST(NoiseShape, SpectrumOfThePeriodicSequenceIsThePowerLaw) {
  // The correlation at all lags of the period, by symmetry, transforms back to the powers.
  const int steps = 16, period = 32;
  for (const double beta : {0.0, 0.5, 1.5, 4.0}) {
    std::vector<double> c = coloured_correlation(beta, steps);
    EXPECT_DOUBLE_EQ(c[0], 1);
    // c(steps) is not among them; it follows from the sum over the odd and even powers.
    double power_sum = 0, half = 0;
    for (int k = 0; k < period; ++k) {
      const double p = std::pow(std::max(std::min(k, period - k), 1), -beta);
      power_sum += p;
      half += k % 2 ? -p : p;
    }
    c.push_back(half / power_sum);
    for (const int k : {1, 2, 5, 11, 16}) {
      double spectrum = 0;
      for (int d = 0; d < period; ++d)
        spectrum += c[std::min(d, period - d)] * std::cos(2 * pi * k * d / period);
      EXPECT_NEAR(spectrum * power_sum / period, std::pow(k, -beta), 1e-12) << beta << " " << k;
    }
  }
}

TEST(NoiseShape, SamplesHaveTheCorrelationOfTheirInput) {
  const int steps = 12, samples = 40000;
  NoiseShape shape({.exponent = {0.0, 2.0}}, steps, 2);
  const SequenceBatch z = shaped(shape, steps, 2, samples);
  const std::vector<double> brown = coloured_correlation(2, steps);
  const double error = 4 / std::sqrt(samples);
  for (int s = 0; s < steps; ++s) {
    for (int t = 0; t <= s; ++t) {
      EXPECT_NEAR(moment(z, s, t, 0), s == t ? 1 : 0, 1.5 * error) << s << " " << t;
      EXPECT_NEAR(moment(z, s, t, 1), brown[s - t], 1.5 * error) << s << " " << t;
    }
  }
}

TEST(NoiseShape, PinnedNoiseContinuesAZeroBeforeTheFirstStep) {
  const int steps = 12, samples = 40000;
  NoiseShape shape({.exponent = 4, .pinned = true}, steps, 1);
  EXPECT_TRUE(shape.pinned());
  const SequenceBatch z = shaped(shape, steps, 1, samples);
  const std::vector<double> c = coloured_correlation(4, steps + 1);
  // The covariance of a normal vector given that its entry before the first one is 0.
  for (std::size_t s = 0; s < 12; ++s)
    for (std::size_t t = 0; t <= s; ++t)
      EXPECT_NEAR(moment(z, static_cast<int>(s), static_cast<int>(t), 0), c[s - t] - c[s + 1] * c[t + 1],
                  6 / std::sqrt(samples))
          << s << " " << t;
}

TEST(NoiseShape, WhiteningTwiceSolvesForTheCorrelation) {
  const int steps = 9;
  NoiseShape shape({.exponent = {1.7, 0.0}}, steps, 2);
  const std::vector<double> c = coloured_correlation(1.7, steps);
  std::vector<double> x(18), y(18);
  for (std::size_t r = 0; r < x.size(); ++r) x[r] = std::sin(1.3 * static_cast<double>(r));
  for (std::size_t s = 0; s < 9; ++s) {
    for (std::size_t t = 0; t < 9; ++t) y[2 * s] += c[s < t ? t - s : s - t] * x[2 * t];
    y[2 * s + 1] = x[2 * s + 1];
  }
  shape.whiten_twice(y.data());
  for (std::size_t r = 0; r < x.size(); ++r) EXPECT_NEAR(y[r], x[r], 1e-12) << r;
}

TEST(NoiseShape, InterpolationPassesThroughTheKnots) {
  const int steps = 13, knots = 4;  // a knot at every fourth step
  const std::vector<double> weights = knot_weights(steps, knots);
  for (int t = 0; t < steps; ++t) {
    double length = 0;
    for (int k = 0; k < knots; ++k) {
      const double w = weights[t * knots + k];
      length += w * w;
      if (t % 4 == 0) {
        EXPECT_NEAR(w, t == 4 * k ? 1 : 0, 1e-12) << t << " " << k;
      }
    }
    EXPECT_NEAR(length, 1, 1e-12) << t;
  }
  for (const double w : knot_weights(5, 1)) EXPECT_EQ(w, 1) << "one knot: a constant";
}

TEST(NoiseShape, InterpolatedSamplesHaveTheCorrelationOfTheWeights) {
  const int steps = 14, knots = 5, samples = 40000;
  NoiseShape shape({.knots = knots}, steps, 2);
  const SequenceBatch z = shaped(shape, steps, 2, samples);
  const std::vector<double> weights = knot_weights(steps, knots);
  const double error = 6 / std::sqrt(samples);
  for (int s = 0; s < steps; ++s) {
    for (int t = 0; t <= s; ++t) {
      double expected = 0;
      for (int k = 0; k < knots; ++k) expected += weights[s * knots + k] * weights[t * knots + k];
      EXPECT_NEAR(moment(z, s, t, 0), expected, error) << s << " " << t;
      EXPECT_NEAR(moment(z, s, t, 1), expected, error) << s << " " << t;
    }
  }
}

/// A sample is a combination of the columns of W, also where it is drawn with the triangular factor.
TEST(NoiseShape, WhiteningTwiceIsThePseudoInverseBetweenKnots) {
  const int steps = 11, knots = 4;
  NoiseShape shape({.knots = knots}, steps, 1);
  const std::vector<double> weights = knot_weights(steps, knots);
  const auto correlate = [&](const std::vector<double>& x) {
    std::vector<double> y(steps);
    for (std::size_t s = 0; s < steps; ++s)
      for (std::size_t t = 0; t < steps; ++t)
        for (std::size_t k = 0; k < knots; ++k)
          y[s] += weights[s * knots + k] * weights[t * knots + k] * x[t];
    return y;
  };
  const SequenceBatch z = shaped(shape, steps, 1, 1);
  std::vector<double> x;
  for (int t = 0; t < steps; ++t) x.push_back(static_cast<double>(z.at(t, 0, 0)));
  std::vector<double> y = x;
  shape.whiten_twice(y.data());
  const std::vector<double> again = correlate(y);
  for (std::size_t t = 0; t < steps; ++t) EXPECT_NEAR(again[t], x[t], 1e-5) << t;
}

TEST(NoiseShape, KnotsHaveTheirRules) {
  EXPECT_THROW(NoiseShape({.exponent = 1, .knots = 4}, 5, 1), std::invalid_argument);
  // As many knots as steps, or more, are white noise.
  for (const int knots : {5, 64}) {
    NoiseShape shape({.knots = knots}, 5, 1);
    std::vector<double> x{1, -2, 3, 0.5, 4}, y = x;
    shape.whiten_twice(y.data());
    for (std::size_t t = 0; t < x.size(); ++t) EXPECT_NEAR(y[t], x[t], 1e-12);
  }
}

TEST(NoiseShape, RejectsSequencesThatAreTooLong) {
  EXPECT_THROW(NoiseShape({.exponent = 1}, 3000, 1), std::invalid_argument);
  EXPECT_THROW(NoiseShape({.knots = 5}, 3000, 1), std::invalid_argument);
  EXPECT_NO_THROW(NoiseShape({}, 3000, 1));
}

}  // namespace
}  // namespace slalom::detail
