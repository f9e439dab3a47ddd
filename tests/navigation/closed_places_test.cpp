// Places that count as closed although the costmap shows room there.
#include "navigation/path_ahead.hpp"

#include <gtest/gtest.h>

namespace slalom::navigation::detail {
namespace {

TEST(ClosedPlaces, KeepsTheLastFourOfManyDeadEnds) {
  ClosedPlaces places;
  for (int i = 0; i < 7; ++i) {
    places.add_dead_end({10.0 * i, 0});
    for (int k = 0; k <= i; ++k) EXPECT_EQ(places.contain({10.0 * k, 0}), k > i - 4) << k << " of " << i;
  }
  EXPECT_EQ(places.all().size(), 4u);
  places.forget_dead_ends();
  EXPECT_FALSE(places.has_dead_ends());
  EXPECT_FALSE(places.contain({60, 0}));
}

TEST(ClosedPlaces, AMeetingIsClosedWhileItLasts) {
  ClosedPlaces places;
  for (int i = 0; i < 4; ++i) places.add_dead_end({10.0 * i, 0});
  {
    const ClosedPlaces::Meeting meeting(places, {{50, 0}, 1});
    EXPECT_TRUE(places.contain({50.9, 0}));
    EXPECT_TRUE(places.contain({30, 0}));
  }
  EXPECT_FALSE(places.contain({50, 0}));
  EXPECT_TRUE(places.contain({30, 0}));
}

}  // namespace
}  // namespace slalom::navigation::detail
