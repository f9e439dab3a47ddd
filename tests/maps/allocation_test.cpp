#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "support/allocations.hpp"

namespace slalom::maps {
namespace {

TEST(MapUpdates, AllocateNothing) {
  std::vector<ReferencePoint> path;
  for (int i = 0; i < 300; ++i) path.push_back({5 * std::cos(0.02 * i), 5 * std::sin(0.02 * i), 0, 1});
  ReferenceField field(path);
  LocalCostMap map;
  const std::vector<float> ranges(1080, 2.0F);
  const Point points[] = {{1, 1}, {2, 0}};
  const long before = testing::allocations();
  ASSERT_GT(before, 0) << "nothing is counted";
  for (int i = 0; i < 5; ++i) {
    field.update({5, 0.1 * i});
    map.update({ranges, -2.35 + 0.01 * i, 4.7 / 1080, 0, 30});
    map.add_points(points);
  }
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace slalom::maps
