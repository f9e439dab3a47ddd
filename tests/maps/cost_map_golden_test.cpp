#include <gtest/gtest.h>

#include <iostream>
#include <string>

#include "golden.hpp"
#include "maps/csv_table.hpp"
#include "slalom/maps/local_cost_map.hpp"

namespace slalom::maps {
namespace {

using slalom::testing::read_csv_numbers;

/// The published program's messages carry these as float32.
LaserScanView published_scan(const std::vector<float>& ranges) {
  return {ranges, static_cast<double>(-2.35F), static_cast<double>(static_cast<float>(4.7 / 1080)), 0, 30};
}

TEST(GoldenMaps, CostMap) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/costmap");
  LocalCostMap map(published_cost_map());
  const auto points = read_csv_numbers(folder / "points.csv", true);
  int scans = 0, cells = 0, differing = 0, used = 0, differing_points = 0;
  for (const auto& line : read_csv_numbers(folder / "scans.csv", false)) {
    const int id = static_cast<int>(line[0]);
    const std::vector<float> ranges(line.begin() + 1, line.end());
    ASSERT_EQ(ranges.size(), 1080u);
    ASSERT_TRUE(map.update(published_scan(ranges)).accepted);

    std::size_t k = 0;
    for (const auto& point : points) {
      if (static_cast<int>(point[0]) != id) continue;
      ASSERT_LT(k, map.points().size()) << "scan " << id;
      const ScanPoint ours = map.points()[k++];
      // %.9g, read back, is the float32 itself.
      differing_points += ours.x != static_cast<float>(point[2]) || ours.y != static_cast<float>(point[3]);
    }
    EXPECT_EQ(k, map.points().size()) << "scan " << id;
    used += static_cast<int>(k);

    const auto grid = read_csv_numbers(folder / ("scan" + std::to_string(id) + "_grid.csv"), false);
    ASSERT_EQ(static_cast<int>(grid.size()), map.geometry().rows);
    for (int row = 0; row < map.geometry().rows; ++row) {
      const auto& values = grid[static_cast<std::size_t>(row)];
      ASSERT_EQ(static_cast<int>(values.size()), map.geometry().columns);
      for (int column = 0; column < map.geometry().columns; ++column, ++cells) {
        differing +=
            *map.cells().at(row, column) != static_cast<float>(values[static_cast<std::size_t>(column)]);
      }
    }
    ++scans;
  }
  EXPECT_GT(scans, 0);
  EXPECT_EQ(differing, 0);
  EXPECT_EQ(differing_points, 0);
  std::cout << "golden controller/costmap: " << scans << " scans, " << used << " points, " << cells
            << " cells compared; " << differing_points << " points and " << differing << " cells differ\n";
}

}  // namespace
}  // namespace slalom::maps
