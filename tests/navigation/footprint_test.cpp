#include "slalom/navigation/footprint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "slalom/core/random.hpp"
#include "support/thrown_words.hpp"

namespace slalom::navigation {
namespace {

using maps::Point;

/// A star-shaped polygon around the origin.
Footprint random_footprint(RandomStream& random) {
  const int count = 3 + static_cast<int>(8 * random.uniform());
  std::vector<Point> vertices;
  for (int i = 0; i < count; ++i) {
    const double angle = 6.2831853 * (i + 0.5 * random.uniform()) / count, radius = 0.2 + random.uniform();
    vertices.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return Footprint(vertices);
}

TEST(Footprint, ARectangleHasItsMeasures) {
  const Footprint body = Footprint::rectangle(0.5, 0.3, 0.6);
  EXPECT_NEAR(body.circumscribed_radius(), std::hypot(0.5, 0.3), 1e-12);
  EXPECT_NEAR(body.half_width(), 0.3, 1e-12);
  EXPECT_TRUE(body.contains({0.49, -0.29}));
  EXPECT_FALSE(body.contains({-0.31, 0}));
  EXPECT_NEAR(body.distance_to_outline({0, 0}), 0.3, 1e-12);
  EXPECT_NEAR(body.distance_to_outline({1.5, 0}), 1, 1e-12);
}

TEST(Footprint, ThePartsCoverTheBodyAndContainNothingElse) {
  RandomStream random({1, 0});
  for (int shape = 0; shape < 100; ++shape) {
    const Footprint body = random_footprint(random);
    for (int i = 0; i < 1000; ++i) {
      const Point p{2.4 * random.uniform() - 1.2, 2.4 * random.uniform() - 1.2};
      const auto reaches = [&](const Footprint::Part& part, double radius) {
        return std::hypot(p.x - part.middle.x, p.y - part.middle.y) < radius - 1e-9;
      };
      const auto& parts = body.parts();
      if (body.contains(p)) {
        EXPECT_TRUE(std::any_of(parts.begin(), parts.end(),
                                [&](const auto& part) { return reaches(part, part.covering + 2e-9); }))
            << shape << ": " << p.x << ", " << p.y;
        const Footprint::Part& part = parts[body.part_at(p)];
        EXPECT_TRUE(reaches(part, part.covering + 2e-9));
      } else {
        for (const auto& part : parts) EXPECT_FALSE(reaches(part, part.contained));
      }
    }
  }
}

TEST(Footprint, TheOutlineHasNoGaps) {
  const Footprint body = Footprint::rectangle(0.5, 0.3, 0.6);
  const std::vector<Point> points = body.outline_points(0.05);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &a = points[i], &b = points[(i + 1) % points.size()];
    EXPECT_LE(std::hypot(a.x - b.x, a.y - b.y), 0.05 + 1e-12);
    EXPECT_LT(body.distance_to_outline(a), 1e-12);
  }
}

TEST(Footprint, WithoutARimIsTheSameShapeButSmaller) {
  const Footprint inner = Footprint::rectangle(0.5, 0.3, 0.6).without_rim(0.06);
  EXPECT_NEAR(inner.half_width(), 0.24, 1e-12);
  EXPECT_NEAR(inner.circumscribed_radius(), 0.8 * std::hypot(0.5, 0.3), 1e-12);
  EXPECT_NEAR(Footprint::rectangle(0.5, 0.3, 0.6).without_rim(1).half_width(), 0.06, 1e-12);
}

TEST(Footprint, RejectsInvalidOutlines) {
  const auto make = [](std::vector<Point> vertices) { return Footprint(vertices); };
  EXPECT_THROW(make({{1, 0}, {0, 1}}), std::invalid_argument);
  EXPECT_THROW(make({{1, 0}, {0, 1}, {std::nan(""), 0}}), std::invalid_argument);
  EXPECT_THROW(make({{1, 1}, {2, 1}, {2, 2}, {1, 2}}), std::invalid_argument);        // origin outside
  EXPECT_THROW(make({{-1, -1}, {1, 1}, {1, -1}, {-1, 1.5}}), std::invalid_argument);  // sides cross
  expect_error_with<std::invalid_argument>({"vertex 1"}, [&] { make({{-1, -1}, {200, 0}, {0, 1}}); });
}

}  // namespace
}  // namespace slalom::navigation
