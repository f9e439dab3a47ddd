// The path of a lap of the racing benchmark through the place where the lap ends.
#include <gtest/gtest.h>

#include "tools/evaluation/racing_benchmark.hpp"

namespace slalom::tools {
namespace {

constexpr double pi = std::numbers::pi, side = 18, corner = 0.6, inside = 0.5;

/// A square with round corners, driven to the left, with its first corner centred on (0, 0); points this far
/// apart, moved to the left by `offset` (all m).
std::vector<maps::ReferencePoint> square(double spacing, double offset) {
  std::vector<maps::ReferencePoint> path;
  const double radius = corner - offset;
  double x = 0, y = 0;  // centre of the corner
  for (int k = 0; k < 4; ++k) {
    const double yaw = 0.5 * pi * k;
    const int turns = std::max(2, static_cast<int>(0.5 * pi * corner / spacing));
    for (int i = 0; i < turns; ++i) {
      const double turned = yaw + 0.5 * pi * i / turns;
      path.push_back({x + radius * std::sin(turned), y - radius * std::cos(turned), turned, 3});
    }
    const double ahead = yaw + 0.5 * pi, from_x = x + radius * std::sin(ahead),
                 from_y = y - radius * std::cos(ahead);
    for (double way = 0; way < side; way += spacing)
      path.push_back({from_x + way * std::cos(ahead), from_y + way * std::sin(ahead), ahead, 5});
    x += side * std::cos(ahead);
    y += side * std::sin(ahead);
  }
  return path;
}

std::vector<maps::Point> places(const std::vector<maps::ReferencePoint>& path) {
  std::vector<maps::Point> points;
  for (const auto& point : path) points.push_back({point.x, point.y});
  return points;
}

/// m of a path on which the benchmark sees the end of a lap: between 99.5 and 99.9 % of a round.
double seen(const std::vector<maps::ReferencePoint>& path, const std::vector<maps::Point>& centre_line,
            const maps::Point& start) {
  const sim::BenchmarkLine line(centre_line);
  const double begin = line.progress(start);
  double way = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto &a = path[i], &b = path[(i + 1) % path.size()];
    for (double share = 0; share < 1; share += 0.05) {
      double lap = line.progress({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)}) - begin;
      if (lap <= 0) lap += 1;
      if (lap > 0.995 && lap <= 0.999) way += 0.05 * std::hypot(b.x - a.x, b.y - a.y);
    }
  }
  return way;
}

TEST(RacingFinish, OnTheInsideOfATightCornerThePathIsLedToWhereTheLapEnds) {
  const auto centre_line = places(square(0.2, 0));
  const auto path = square(0.15, inside);
  const maps::Point start{corner * std::sin(pi / 4),
                          -corner * std::cos(pi / 4)};  // half-way round the corner
  ASSERT_LT(seen(path, centre_line, start), 0.2);
  const auto led = path_through_finish(path, centre_line, start);
  ASSERT_TRUE(led);
  EXPECT_GT(seen(*led, centre_line, start), 0.25);
  int kept = 0;
  for (const auto& point : path) {
    const bool found = std::any_of(led->begin(), led->end(), [&](const auto& other) {
      return other.x == point.x && other.y == point.y && other.yaw == point.yaw;
    });
    EXPECT_TRUE(found || std::hypot(point.x - start.x, point.y - start.y) < 5) << point.x << ' ' << point.y;
    kept += found;
  }
  EXPECT_LT(kept, static_cast<int>(path.size()) - 20) << "the others are led";
  for (std::size_t i = 0; i < led->size(); ++i) {
    const auto &a = (*led)[i], &b = (*led)[(i + 1) % led->size()];
    EXPECT_LT(std::hypot(b.x - a.x, b.y - a.y), 0.5) << i << ": closed, without a gap";
  }
}

TEST(RacingFinish, APathOfWhichNoPointIsKeptIsClosed) {
  const auto centre_line = places(square(0.2, 0));
  const maps::Point start{corner * std::sin(pi / 4), -corner * std::cos(pi / 4)};
  const auto led = path_through_finish({{0, 0, 0, 3}}, centre_line, start);
  ASSERT_TRUE(led);
  const auto &first = led->front(), &last = led->back(), &before = (*led)[led->size() - 2];
  EXPECT_DOUBLE_EQ(last.yaw, std::atan2(first.y - before.y, first.x - before.x));
}

TEST(RacingFinish, OnAStraightThePathWillDo) {
  const auto centre_line = places(square(0.2, 0));
  EXPECT_FALSE(path_through_finish(square(0.15, inside), centre_line, {corner, 0.5 * side}));
}

}  // namespace
}  // namespace slalom::tools
