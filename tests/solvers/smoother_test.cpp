#include "solvers/sampling/smoother.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slalom::detail {
namespace {

/// The smoothed sequence of zeros with a 1 at place `at`: a column of the smoothing matrix.
std::vector<float> response(int steps, int half_width, int degree, int at) {
  Smoother smoother(steps, 1, half_width, degree);
  std::vector<float> u(static_cast<std::size_t>(steps));
  u[static_cast<std::size_t>(at)] = 1;
  smoother.apply(u.data());
  return u;
}

TEST(Smoother, CoefficientsOfThePublishedTables) {
  // Savitzky and Golay 1964, tables I: quadratic and cubic, 5 points: (-3, 12, 17, 12, -3) / 35;
  // 7 points: (-2, 3, 6, 7, 6, 3, -2) / 21; quartic and quintic, 7 points: (5, -30, 75, 131, ...) / 231.
  const auto check = [](int half_width, int degree, const std::vector<double>& expected) {
    const int at = 10;
    const std::vector<float> u = response(21, half_width, degree, at);
    for (int j = -half_width; j <= half_width; ++j) {
      EXPECT_NEAR(u[static_cast<std::size_t>(at + j)], expected[static_cast<std::size_t>(std::abs(j))], 1e-6)
          << j;
    }
    EXPECT_EQ(u[static_cast<std::size_t>(at + half_width + 1)], 0);
  };
  check(2, 2, {17.0 / 35, 12.0 / 35, -3.0 / 35});
  check(2, 3, {17.0 / 35, 12.0 / 35, -3.0 / 35});
  check(3, 2, {7.0 / 21, 6.0 / 21, 3.0 / 21, -2.0 / 21});
  check(3, 4, {131.0 / 231, 75.0 / 231, -30.0 / 231, 5.0 / 231});
  check(3, 0, {1.0 / 7, 1.0 / 7, 1.0 / 7, 1.0 / 7});
}

TEST(Smoother, FirstEntryIsTheFitOfTheFirstWindow) {
  // A line through five points, at its left end: (3, 2, 1, 0, -1) / 5.
  const double expected[] = {0.6, 0.4, 0.2, 0.0, -0.2};
  for (int at = 0; at < 5; ++at) EXPECT_NEAR(response(9, 2, 1, at)[0], expected[at], 1e-6) << at;
}

TEST(Smoother, PolynomialsOfItsDegreeStayAsTheyAre) {
  const int steps = 15;
  Smoother smoother(steps, 2, 4, 3);
  std::vector<float> u;
  for (int k = 0; k < steps; ++k) {
    const double x = 0.1 * k;
    u.push_back(static_cast<float>(1 - 2 * x + 3 * x * x - x * x * x));
    u.push_back(static_cast<float>(x));
  }
  std::vector<float> smooth = u;
  smoother.apply(smooth.data());
  for (std::size_t r = 0; r < u.size(); ++r) EXPECT_NEAR(smooth[r], u[r], 2e-6) << r;
}

TEST(Smoother, ShortSequencesNarrowTheWindow) {
  for (const int steps : {1, 2, 3, 4}) {
    Smoother smoother(steps, 1, 5, 3);
    std::vector<float> u;
    for (int k = 0; k < steps; ++k) u.push_back(static_cast<float>(std::sin(3.0 * k)));
    std::vector<float> smooth = u;
    smoother.apply(smooth.data());
    // As many coefficients as entries: nothing is left to smooth.
    for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(smooth[k], u[k], 1e-6);
  }
}

}  // namespace
}  // namespace slalom::detail
