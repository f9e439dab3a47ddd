#include "slalom/maps/local_cost_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace slalom::maps::local_cost_map_test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

int occupied_cells(const LocalCostMap& map) {
  int count = 0;
  for (int row = 0; row < map.geometry().rows; ++row) {
    for (int column = 0; column < map.geometry().columns; ++column)
      count += *map.cells().at(row, column) != 0;
  }
  return count;
}

TEST(LocalCostMap, MarksEveryPositionWhereTheBodyCoversAPoint) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in_x(-1.9, 7.9), in_y(-4.9, 4.9), unit(0, 1);
  const LocalCostMapOptions options{.margin = 0.02};
  LocalCostMap map(options);
  const Footprint& body = options.footprint;
  for (int trial = 0; trial < 200; ++trial) {
    const Point point{in_x(random), in_y(random)};
    map.clear();
    map.add_points({&point, 1});
    for (int i = 0; i < 50; ++i) {
      // A position from which the point lies somewhere in the body with its margin.
      const double x = point.x - (unit(random) * (body.front + body.rear + 0.04) - body.rear - 0.02);
      const double y = point.y - (unit(random) * (body.left + body.right + 0.04) - body.right - 0.02);
      EXPECT_EQ(map.at(x, y), 100) << point.x << ' ' << point.y;
      // And one where it is more than a cell's width away from the body.
      const double aside = point.y + (i % 2 ? 1 : -1) * (body.left + 0.02 + options.resolution + 0.001);
      if (std::abs(aside) < 4.99) {
        EXPECT_EQ(map.at(x, aside), std::abs(aside) < 5 && x > -2 && x < 8 ? 0 : 100);
      }
    }
  }
}

TEST(LocalCostMap, PublishedInflationIsOneCellShortToOneSide) {
  LocalCostMap map(published_cost_map());
  const Point point{3.025, 0.025};  // the centre of a cell
  map.add_points({&point, 1});
  EXPECT_EQ(occupied_cells(map), 13 * 6);
  for (const auto& [x, y] : {Point{3.025, 0.175}, {3.025, -0.075}, {3.175, 0.025}, {2.575, 0.025}})
    EXPECT_EQ(map.at(x, y), 100) << x << ", " << y;
  for (const auto& [x, y] : {Point{3.025, -0.125}, {3.225, 0.025}, {2.525, 0.025}})
    EXPECT_EQ(map.at(x, y), 0) << x << ", " << y;
}

TEST(LocalCostMap, PointsOutsideTheMapReachIntoItUnlessForgotten) {
  const Point point{8.2, 0};
  LocalCostMap map;
  map.add_points({&point, 1});
  EXPECT_EQ(map.at(7.9, 0), 100);
  LocalCostMap forgetful(published_cost_map());
  forgetful.add_points({&point, 1});
  EXPECT_EQ(occupied_cells(forgetful), 0);
}

TEST(LocalCostMap, PointsFarAwayOrNotFiniteDoNothing) {
  const Point points[] = {{1e300, 0}, {-1e300, 1e300}, {NAN, 0}, {0, INFINITY},
                          {3, 6},     {3, -6},         {9, 0},   {-3, 0}};
  for (const auto& options : {LocalCostMapOptions{}, published_cost_map()}) {
    LocalCostMap map(options);
    map.add_points(points);
    EXPECT_EQ(occupied_cells(map), 0);
  }
}

TEST(LocalCostMap, BadReadingsAreDroppedAndCounted) {
  LocalCostMap map;
  const std::vector<float> ranges{nan, infinity, -infinity, -1, 0.01F, 30, 31, 0.1F, 2, 29.9F};
  const ScanReport report = map.update({ranges, 0, 1e-3, 0.05, 30});
  EXPECT_TRUE(report.accepted);
  EXPECT_EQ(std::tuple(report.beams, report.invalid, report.on_body, report.used), std::tuple(10, 7, 1, 2));
  EXPECT_EQ(map.points().size(), 2u);
  EXPECT_EQ(map.at(2.2, 0), 100);
}

TEST(LocalCostMap, BeamsWhoseAngleIsNotFiniteAreDroppedAndCounted) {
  LocalCostMap map;
  const std::vector<float> ranges(4, 2.0F);
  const ScanReport report = map.update({ranges, 0, 1e308, 0.05, 30});
  EXPECT_EQ(report.invalid, 2);
  EXPECT_EQ(report.used, 2);
  EXPECT_EQ(map.points().size(), 2u);
}

TEST(LocalCostMap, KeepsObstaclesBesideTheBody) {
  const std::vector<float> ranges{0.17F, 0.1F};  // 2.5 cm within the front of the body, and 9.5 cm
  const LaserScanView scan{ranges, 0, 1e-3, 0.05, 30};
  LocalCostMap map, published(published_cost_map());
  EXPECT_EQ(map.update(scan).on_body, 1);
  EXPECT_EQ(published.update(scan).on_body, 2);
}

TEST(LocalCostMap, RejectsUnusableScans) {
  LocalCostMap map({.max_beams = 4});
  const std::vector<float> five(5, 2.0F), four(4, 2.0F);
  ASSERT_TRUE(map.update({four, 0, 0.1, 0, 30}).accepted);
  ASSERT_GT(occupied_cells(map), 0);
  const LaserScanView bad[] = {{{}, 0, 0.1, 0, 30},        {five, 0, 0.1, 0, 30},   {four, NAN, 0.1, 0, 30},
                               {four, 0, INFINITY, 0, 30}, {four, 0, 0.1, NAN, 30}, {four, 0, 0.1, 0, NAN},
                               {four, 0, 0.1, 2, 1},       {four, 0, 0.1, -1, 30}};
  for (const LaserScanView& scan : bad) {
    EXPECT_FALSE(map.update(scan).accepted);
    EXPECT_EQ(occupied_cells(map), 0);
  }
}

TEST(LocalCostMap, TheLaserMayBeTurnedAndTheScanMayChange) {
  LocalCostMap map({.laser = {0.1, 0.05, M_PI / 2}});
  const std::vector<float> one{2.0F}, two{2.0F, 2.0F};
  map.update({one, 0, 0.1, 0, 30});
  EXPECT_NEAR(map.points()[0].x, 0.1, 1e-6);
  EXPECT_NEAR(map.points()[0].y, 2.05, 1e-6);
  map.update({two, 0, -M_PI / 2, 0, 30});
  EXPECT_NEAR(map.points()[1].x, 2.1, 1e-6);
  EXPECT_NEAR(map.points()[1].y, 0.05, 1e-6);
  map.update({one, -M_PI / 2, 0.3, 0, 30});
  EXPECT_NEAR(map.points()[0].x, 2.1, 1e-6);
}

TEST(LocalCostMap, OutsideIsTheRing) {
  LocalCostMap map({.outside = 7});
  for (const auto& [x, y] : {Point{8.001, 0}, {-2.001, 0}, {3, 5.001}, {NAN, 0}}) EXPECT_EQ(map.at(x, y), 7);
  EXPECT_EQ(map.at(3, 0), 0);
  for (int i = -1; i <= 200; ++i) {
    EXPECT_EQ(*map.cells().at(-1, i), 7);
    EXPECT_EQ(*map.cells().at(200, i), 7);
    EXPECT_EQ(*map.cells().at(i, -1), 7);
    EXPECT_EQ(*map.cells().at(i, 200), 7);
  }
}

TEST(LocalCostMap, ReadsThePointsOfAScanWithoutMarkingThem) {
  const std::vector<float> ranges{1.0f, nan, 2.0f, 0.01f, 3.0f};
  const LaserScanView scan{ranges, -0.2, 0.1, 0.05, 30};
  LocalCostMap marked, read;
  const ScanReport expected = marked.update(scan);
  ASSERT_TRUE(read.update(scan).accepted);
  ASSERT_GT(occupied_cells(read), 0);
  const ScanReport report = read.read(scan);
  EXPECT_EQ(report.accepted, expected.accepted);
  EXPECT_EQ(report.used, expected.used);
  EXPECT_EQ(report.invalid, expected.invalid);
  ASSERT_EQ(read.points().size(), marked.points().size());
  for (std::size_t i = 0; i < read.points().size(); ++i) {
    EXPECT_EQ(read.points()[i].x, marked.points()[i].x);
    EXPECT_EQ(read.points()[i].y, marked.points()[i].y);
  }
  EXPECT_EQ(occupied_cells(read), 0) << "what was marked before is forgotten";
  read.update(scan);
  EXPECT_EQ(occupied_cells(read), occupied_cells(marked));
}

}  // namespace
}  // namespace slalom::maps::local_cost_map_test
