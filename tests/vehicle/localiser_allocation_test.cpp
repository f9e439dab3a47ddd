#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "vehicle/localiser_drive.hpp"

namespace slalom::vehicle {
namespace {

TEST(Localiser, AllocatesNothingAfterConstruction) {
  const test::Place place("wren");
  Localiser localiser(place.course.map);
  test::Drive drive(place, place.at(0.2), 3);
  for (int i = 0; i < 30; ++i, drive.step()) {
    if (i == 10) localiser.start_at(drive.truth());
    if (i == 20) drive.kidnap(place.at(0.7));
    const LocaliserInput input = drive.input();
    const long before = testing::allocations();
    ASSERT_GT(before, 0) << "nothing is counted";
    localiser.update(input);
    EXPECT_EQ(testing::allocations(), before);
  }
}

}  // namespace
}  // namespace slalom::vehicle
