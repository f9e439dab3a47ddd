// Obstacles that block the road are distinguished from those that can be passed.
#include "slalom/evaluation/passability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/courses.hpp"

namespace slalom::evaluation::passability_test {
namespace {

class Passability : public ::testing::Test {
 protected:
  /// A box across the course at an arc length (m): its middle so far to the left of the line, so wide.
  sim::Box across(double arc, double left, double width) const {
    const maps::Pose on = environment_->track->lap_path()->at(arc);
    return {{on.x - left * std::sin(on.yaw), on.y + left * std::cos(on.yaw), on.yaw}, 0.3, width};
  }
  std::vector<int> named(const std::vector<sim::Box>& boxes) const {
    return impassable_obstacles(*environment_->track, boxes);
  }

  std::shared_ptr<const Environment> environment_ = course("wren");
};

TEST_F(Passability, ParkedCarsCanBePassed) {
  for (double arc = 0; arc < environment_->track->lap_path()->length(); arc += 2)
    EXPECT_TRUE(named({across(arc, 0, 0.31)}).empty()) << arc;
}

TEST_F(Passability, ABarrierClosesTheRoad) {
  for (double arc = 0; arc < environment_->track->lap_path()->length(); arc += 2)
    EXPECT_EQ(named({across(arc, 0, 8)}), std::vector<int>{0}) << arc;
  EXPECT_EQ(named({across(2, 0, 0.31), across(12, 0, 8)}), std::vector<int>{1});
}

TEST_F(Passability, ReportsBothObstaclesThatBlockTheRoadTogether) {
  // A wall on each side of the line with a gap between them, in metres.
  const auto with_gap = [&](double gap) {
    const double width = 4;
    return named({across(5, 0.5 * (gap + width), width), across(5, -0.5 * (gap + width), width)});
  };
  EXPECT_TRUE(with_gap(0.5).empty());
  EXPECT_EQ(with_gap(0.1), (std::vector<int>{0, 1}));
}

TEST_F(Passability, NeverReportsAPassableObstacle) {
  // Gaps a hair wider than the disc, at any angle to the cells.
  const double diameter = 2 * PassabilityOptions{}.radius;
  for (int k = 0; k < 24; ++k) {
    const double arc = environment_->track->lap_path()->length() * k / 24, width = 4, gap = diameter + 0.002;
    EXPECT_TRUE(
        named({across(arc, 0.5 * (gap + width), width), across(arc, -0.5 * (gap + width), width)}).empty())
        << arc;
  }
}

}  // namespace
}  // namespace slalom::evaluation::passability_test
