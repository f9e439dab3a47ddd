#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "vehicle/localiser_drive.hpp"

namespace slalom::vehicle {
namespace {

TEST(Localiser, ACopyGoesOnWithTheSameBitsAndAllocatesNothing) {
  const test::Place place("wren");
  Localiser original(place.course.map);
  test::Drive drive(place, place.at(0.2), 3);
  original.start_at(drive.truth());
  for (int i = 0; i < 20; ++i, drive.step()) {
    if (i == 10) drive.kidnap(place.at(0.7));
    Localiser copy = original;
    const LocaliserInput input = drive.input();
    const long before = testing::allocations();
    ASSERT_GT(before, 0) << "nothing is counted";
    const LocaliserOutput after = copy.update(input);
    const LocaliserOutput& expected = original.update(input);
    EXPECT_EQ(testing::allocations(), before);
    EXPECT_EQ(after.pose.x, expected.pose.x);
    EXPECT_EQ(after.pose.yaw, expected.pose.yaw);
    EXPECT_EQ(after.covariance[0][0], expected.covariance[0][0]);
    EXPECT_EQ(after.fit, expected.fit);
    EXPECT_EQ(copy.particle(copy.particle_count() / 2).pose.x,
              original.particle(original.particle_count() / 2).pose.x);
    if (i % 2 == 0) original = copy;
  }
}

}  // namespace
}  // namespace slalom::vehicle
