#include "slalom/navigation/path_planner.hpp"

#include <gtest/gtest.h>

#include "navigation/grids.hpp"

namespace slalom::navigation::path_planner_test {
namespace {

const Footprint body = Footprint::rectangle(0.35, 0.35, 0.5);

/// 8 x 6 m, divided by a wall at x = 4 with doors of 0.9 m at y = 1.5 and at y = 4.5.
maps::OccupancyGrid two_doors() {
  maps::OccupancyGrid grid = free_grid(0, 0, 8, 6);
  fill(grid, 3.9, 0, 4.1, 6);
  for (const double y : {1.5, 4.5}) fill(grid, 3.9, y - 0.45, 4.1, y + 0.45, maps::Occupancy::free);
  return grid;
}

/// m, where a path crosses the wall.
double crossing(const std::vector<maps::Pose>& path) {
  for (const maps::Pose& pose : path)
    if (pose.x > 4) return pose.y;
  return std::nan("");
}

TEST(PathPlanner, PathsLeadThroughTheNearerDoor) {
  const Costmap costmap = costmap_of(two_doors());
  for (const double y : {1.0, 5.0}) {
    const auto path = plan_path(costmap, body, {1, y, 0}, {7, y, 1});
    EXPECT_NEAR(crossing(path), y < 3 ? 1.5 : 4.5, 0.25);
    EXPECT_EQ(path.back().yaw, 1);
    for (const maps::Pose& pose : path) EXPECT_GE(costmap.distance(pose.x, pose.y), body.half_width());
    for (std::size_t i = 1; i < path.size(); ++i)
      EXPECT_LT(std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y), 0.12);
  }
}

TEST(PathPlanner, ThereIsNoPathThroughADoorThatIsTooNarrow) {
  maps::OccupancyGrid grid = two_doors();
  fill(grid, 3.9, 1.2, 4.1, 6);  // 0.5 m or less are left of either door
  EXPECT_TRUE(plan_path(costmap_of(grid), body, {1, 1, 0}, {7, 1, 0}).empty());
  EXPECT_TRUE(plan_path(costmap_of(two_doors()), body, {1, 1, 0}, {4, 3, 0}).empty()) << "into a wall";
  EXPECT_TRUE(plan_path(costmap_of(two_doors()), body, {-1, 1, 0}, {7, 1, 0}).empty()) << "off the map";
}

TEST(PathPlanner, PathsHaveNoKinkAtTheGoalAndAreAsLongAsTheyMustBe) {
  const Costmap costmap = costmap_of(free_grid(0, 0, 8, 6));
  for (const maps::Pose& goal : {maps::Pose{6.01, 3.04, 0}, {6.04, 3.01, 0}, {6.02, 3.02, 0}}) {
    const auto path = plan_path(costmap, body, {1, 3.02, 0}, goal);
    for (const maps::Pose& pose : path) EXPECT_LT(std::abs(pose.yaw), 0.25) << goal.x << ", " << goal.y;
  }
  maps::OccupancyGrid shelves = free_grid(0, 0, 40, 21);
  for (int i = 1; i < 7; ++i) fill(shelves, i % 2 ? 0 : 1.5, 3 * i, i % 2 ? 38.5 : 40, 3 * i + 0.2);
  const Costmap hall = costmap_of(shelves);
  const auto path = plan_path(hall, body, {1, 1, 0}, {39, 20, 0});
  EXPECT_GT(path.size() * PathPlanner::spacing, 240);
  for (std::size_t i = 1; i < path.size(); ++i)
    ASSERT_LT(std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y), 0.12) << i;
}

TEST(PathPlanner, KeepsToTheWayThatWasChosen) {
  const Costmap costmap = costmap_of(two_doors());
  const std::vector<maps::Pose> chosen = plan_path(costmap, body, {1, 3.2, 0}, {7, 3.2, 0});
  ASSERT_GT(crossing(chosen), 4) << "a little nearer";
  PathPlanner planner(costmap.geometry(), body.half_width());
  const auto crossed = [&](std::span<const maps::Pose> kept, std::span<const maps::ClosedDisc> closed) {
    EXPECT_TRUE(planner.begin(costmap, {1, 2.8}, kept, closed));
    EXPECT_TRUE(planner.advance(costmap));
    for (const maps::Point& point : planner.path_to({7, 2.8}))
      if (point.x > 4) return point.y;
    return std::nan("");
  };
  EXPECT_LT(crossed({}, {}), 2) << "the other one is nearer now";
  EXPECT_GT(crossed(chosen, {}), 4);
  const maps::ClosedDisc dead_end[] = {{{4, 4.5}, 0.5}};
  EXPECT_LT(crossed(chosen, dead_end), 2);
}

TEST(PathPlanner, FindsTheSameInSlices) {
  const Costmap costmap = costmap_of(two_doors());
  PathPlanner whole(costmap.geometry(), body.half_width()), sliced = whole;
  whole.begin(costmap, {1, 2.8});
  whole.advance(costmap);
  sliced.begin(costmap, {1, 2.8});
  int slices = 1;
  while (!sliced.advance(costmap, 1000)) ++slices;
  const int cells = costmap.geometry().rows * costmap.geometry().columns;
  EXPECT_GT(slices, cells / 2000);
  EXPECT_LE(slices, 2 * cells / 1000) << "each cell is reached, some twice";
  EXPECT_FALSE(sliced.is_searching());
  for (const maps::Point goal : {maps::Point{7, 2.8}, {6, 1}, {0.5, 5}})
    EXPECT_EQ(sliced.cost_to(goal), whole.cost_to(goal));
}

}  // namespace
}  // namespace slalom::navigation::path_planner_test
