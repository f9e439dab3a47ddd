// Places that count as closed although a map shows room.
#include "slalom/maps/closed_discs.hpp"

#include <gtest/gtest.h>

namespace slalom::maps::closed_discs_test {
namespace {

TEST(ClosedDiscs, KeepsTheLastFourOfManyDeadEnds) {
  ClosedDiscs discs;
  for (int i = 0; i < 7; ++i) {
    discs.add_dead_end({{10.0 * i, 0}, 0.5});
    for (int k = 0; k <= i; ++k) EXPECT_EQ(discs.contain({10.0 * k, 0}), k > i - 4) << k << " of " << i;
  }
  EXPECT_EQ(discs.all().size(), 4u);
  discs.forget_dead_ends();
  EXPECT_FALSE(discs.has_dead_ends());
  EXPECT_FALSE(discs.contain({60, 0}));
}

TEST(ClosedDiscs, AMeetingIsClosedWhileItLasts) {
  ClosedDiscs discs;
  for (int i = 0; i < 4; ++i) discs.add_dead_end({{10.0 * i, 0}, 0.5});
  discs.begin_meeting({{50, 0}, 1});
  EXPECT_TRUE(discs.contain({50.9, 0}));
  EXPECT_TRUE(discs.contain({30, 0}));
  discs.end_meeting();
  EXPECT_FALSE(discs.contain({50, 0}));
  EXPECT_TRUE(discs.contain({30, 0}));
}

}  // namespace
}  // namespace slalom::maps::closed_discs_test
