// Readings that end on something that moves are dropped, whatever the turn of the scanner, and no others.
#include "slalom/maps/moving_obstacles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "support/predicted.hpp"

namespace slalom::maps {
namespace {

/// A square of 0.4 m that has one pose.
const testing::Predicted square(0.4, 0.4, {{1, {3, 0, 0}}}, 1);

TEST(MovingReadings, AreDroppedAtTheObstacleAlone) {
  constexpr int beams = 360;
  const double increment = 2 * std::numbers::pi / beams;
  for (const double yaw : {0.0, 1.0, 3.1, -2.0}) {
    const Pose sensor{0, 0, yaw};
    std::vector<float> ranges(beams, 2.9f);  // on the obstacle ahead, elsewhere beside it
    ranges[0] = 5;
    const LaserScanView scan{ranges, -std::numbers::pi, increment, 0, 10};
    std::vector<float> kept = ranges;
    drop_readings_of(square.obstacle, 0.1, sensor, scan, kept);
    for (int i = 0; i < beams; ++i) {
      const auto beam = static_cast<std::size_t>(i);
      const double angle = yaw - std::numbers::pi + i * increment, range = static_cast<double>(ranges[beam]);
      const bool on =
          std::abs(range * std::cos(angle) - 3) <= 0.3 && std::abs(range * std::sin(angle)) <= 0.3;
      EXPECT_EQ(std::isnan(kept[beam]), on) << yaw << ", beam " << i;
    }
  }
}

TEST(MovingReadings, StayWhereBeamsRunClockwiseOrTheObstacleHasNoPoses) {
  const std::vector<float> ranges(360, 2.9f);
  std::vector<float> kept = ranges;
  drop_readings_of(square.obstacle, 0.1, {}, {ranges, std::numbers::pi, -std::numbers::pi / 180, 0, 10},
                   kept);
  EXPECT_EQ(kept, ranges);
  drop_readings_of({}, 0.1, {}, {ranges, -std::numbers::pi, std::numbers::pi / 180, 0, 10}, kept);
  EXPECT_EQ(kept, ranges);
}

}  // namespace
}  // namespace slalom::maps
