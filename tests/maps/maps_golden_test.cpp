
#include <iostream>

#include "golden.hpp"
#include "maps/grid_map_csv.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::maps {
namespace {

using slalom::testing::read_csv_numbers;

/// Columns opt_x, opt_y, ref_v; the yaw is the direction to the next row, at the last one as before.
std::vector<ReferencePoint> load_path(const std::filesystem::path& file) {
  std::vector<ReferencePoint> path;
  for (const auto& row : read_csv_numbers(file, true)) path.push_back({row.at(0), row.at(1), 0, row.at(11)});
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    path[i].yaw = std::atan2(path[i + 1].y - path[i].y, path[i + 1].x - path[i].x);
  }
  path.back().yaw = path[path.size() - 2].yaw;
  return path;
}

double relative(double a, double b) {
  return std::abs(a - b) / std::max(1.0, std::abs(b));
}

TEST(GoldenMaps, ReferenceField) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/reference_sdf");
  const auto path = load_path(folder / "ego_ref_waypoint.csv");
  const auto waypoints = read_csv_numbers(folder / "waypoints.csv", true);
  const auto samples = read_csv_numbers(folder / "samples.csv", true);
  ReferenceField field(path, published_reference_field());
  int poses = 0, compared = 0;
  double worst = 0;
  for (const auto& pose : read_csv_numbers(folder / "poses.csv", true)) {
    ASSERT_TRUE(field.update({pose[1], pose[2]}));
    EXPECT_EQ(field.nearest(), static_cast<int>(pose[4]));
    EXPECT_EQ(field.window()[0], static_cast<int>(pose[5]));
    std::size_t k = 0;
    for (const auto& waypoint : waypoints) {
      if (waypoint[0] != pose[0]) continue;
      ASSERT_LT(k, field.window().size());
      const int index = field.window()[k++];
      EXPECT_EQ(index, static_cast<int>(waypoint[2])) << "pose " << pose[0] << ", waypoint " << k - 1;
      EXPECT_NEAR(path[index].yaw, waypoint[5], 1e-12);
    }
    EXPECT_EQ(k, field.window().size());
    for (const auto& sample : samples) {
      if (sample[0] != pose[0]) continue;
      // A sample on the edge of two cells is looked up by its index.
      const int row = static_cast<int>(sample[3]), column = static_cast<int>(sample[4]);
      EXPECT_EQ(field.geometry().row(sample[1]), row);
      EXPECT_EQ(field.geometry().column(sample[2]), column);
      const ReferenceCell cell = field.at(sample[1], sample[2]);
      const double error = std::max({relative(cell.distance, sample[5]), relative(cell.yaw, sample[6]),
                                     relative(cell.speed, sample[7])});
      EXPECT_LE(error, 1e-6) << "pose " << pose[0] << " at " << sample[1] << ", " << sample[2];
      worst = std::max(worst, error);
      ++compared;
    }
    ++poses;
  }
  EXPECT_GT(compared, 0);
  std::cout << "golden controller/reference_sdf: " << poses << " poses, " << compared
            << " samples compared; largest error " << worst << '\n';
}

/// The numbers behind a key of maps.json, in the file's order; it is flat enough to be searched as text.
std::vector<std::pair<std::string, Point>> robot_positions(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::vector<std::pair<std::string, Point>> positions;
  const std::string x_key = "\"robot_x\":", y_key = "\"robot_y\":";
  for (auto at = text.find(x_key); at != std::string::npos; at = text.find(x_key, at + 1)) {
    const auto name_end = text.rfind("\":", at), name_begin = text.rfind('"', name_end - 1) + 1;
    positions.push_back({text.substr(name_begin, name_end - name_begin),
                         {std::stod(text.substr(at + x_key.size())),
                          std::stod(text.substr(text.find(y_key, at) + y_key.size()))}});
  }
  return positions;
}

TEST(GoldenMaps, ReferenceMaps) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/maps");
  const auto path_file = folder.parent_path() / "reference_sdf" / "ego_ref_waypoint.csv";
  if (!std::filesystem::exists(path_file)) GTEST_SKIP() << "no waypoints: " << path_file << " is missing";
  ReferenceField field(load_path(path_file), published_reference_field());
  int maps = 0, cells = 0;
  double worst = 0;
  for (const auto& [id, robot] : robot_positions(folder / "maps.json")) {
    if (!std::filesystem::exists(folder / (id + "_distance.csv"))) continue;
    const auto expected = slalom::testing::load_reference_map(folder, id, robot.x, robot.y);
    ASSERT_TRUE(field.update({robot.x, robot.y}));
    ASSERT_EQ(expected.geometry.rows, field.geometry().rows);
    ASSERT_EQ(expected.geometry.columns, field.geometry().columns);
    // The ring is compared too: -1 and `rows` are cells of it.
    for (int row = -1; row <= expected.geometry.rows; ++row) {
      for (int column = -1; column <= expected.geometry.columns; ++column, ++cells) {
        for (int layer = 0; layer < 4; ++layer) {
          const double error =
              relative(field.cells().at(row, column)[layer], expected.cells.at(row, column)[layer]);
          ASSERT_LE(error, 1e-6) << id << ": row " << row << ", column " << column << ", layer " << layer;
          worst = std::max(worst, error);
        }
      }
    }
    ++maps;
  }
  EXPECT_GT(maps, 0);
  std::cout << "golden controller/maps: " << maps << " reference maps, " << cells
            << " cells compared; largest error " << worst << '\n';
}

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
      const auto& values = grid[row];
      ASSERT_EQ(static_cast<int>(values.size()), map.geometry().columns);
      for (int column = 0; column < map.geometry().columns; ++column, ++cells) {
        differing += *map.cells().at(row, column) != static_cast<float>(values[column]);
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
