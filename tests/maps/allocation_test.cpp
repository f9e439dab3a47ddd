#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"

namespace {
std::atomic<int> allocations{0};
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace slalom::maps {
namespace {

TEST(MapsLoop, UpdatesAllocateNothing) {
  std::vector<ReferencePoint> path;
  for (int i = 0; i < 300; ++i) path.push_back({5 * std::cos(0.02 * i), 5 * std::sin(0.02 * i), 0, 1});
  ReferenceField field(path);
  LocalCostMap map;
  const std::vector<float> ranges(1080, 2.0F);
  const OccupancyGrid obstacles{20, 20, 0.1, {}, std::vector<Occupancy>(400, Occupancy::occupied)};
  const Point points[] = {{1, 1}, {2, 0}};
  const int before = allocations;
  ASSERT_GT(before, 0) << "nothing is counted";
  for (int i = 0; i < 5; ++i) {
    field.update({5, 0.1 * i});
    map.update({ranges, -2.35 + 0.01 * i, 4.7 / 1080, 0, 30});
    map.add_points(points);
    map.add_grid(obstacles, {0.1 * i, 0, 0.2});
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace slalom::maps
