#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "slalom/evaluation/rooms/room_drive.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::evaluation {
namespace {

std::string cylinder(double x, double y) {
  const std::string pose = std::to_string(x) + " " + std::to_string(y) + " 0 0 0 0";
  return "<model name='unit_cylinder_1'>\n<pose frame=''>" + pose +
         "</pose>\n<radius>0.075000</radius>\n<radius>0.075000</radius>\n</model>\n";
}

/// An array of numpy with the cells (15, 0) and (15, 29).
std::string path_file() {
  std::string header = "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2), }";
  header.resize(69, ' ');
  std::string bytes = std::string("\x93NUMPY\x01\0", 8) + char(header.size() + 1) + '\0' + header + '\n';
  for (const int value : {15, 0, 15, 29}) bytes += char(value) + std::string(7, '\0');
  return bytes;
}

TEST(BarnScenarios, HaveThePostsAndTheOptimalTimeOfTheirFiles) {
  const testing::ScopedFolder folder;
  folder.write("world_0.world", "<pose frame=''>0 0 10 0 -0 0</pose>" + cylinder(-2.4, 8) + cylinder(-1, 7) +
                                    "<state><model name='unit_cylinder_1'><pose frame=''>0 0 0</pose>");
  std::filesystem::create_directory(folder.path() / "path_files");
  folder.write("path_files/path_0.npy", path_file());
  const auto scenarios = barn_scenarios(folder.path(), 300);
  ASSERT_EQ(scenarios.size(), 1u);
  const RoomScenario& world = scenarios[0];
  EXPECT_EQ(world.name, "barn-0");
  ASSERT_EQ(world.room.posts.size(), 2u);
  EXPECT_NEAR(world.goal.y - world.start.y, 10, 1e-12);
  EXPECT_NEAR(world.room.posts[0].middle.x - world.start.x, -0.15, 1e-9);
  EXPECT_NEAR(world.room.posts[0].middle.y - world.start.y, 5, 1e-9);
  // From (-2.25, 3) to (-2.325, 5.075), (-2.325, 9.425) and (-2.25, 13).
  EXPECT_NEAR(world.optimal_time, (std::hypot(0.075, 2.075) + 4.35 + std::hypot(0.075, 3.575)) / 2, 1e-9);
  RoomDriver driver;
  driver.solver = navigation::svg_mppi_options(world.base);
  driver.predict_movers = false;
  const RoomDrive drive = drive_room(world, driver, 1, 100);
  EXPECT_EQ(drive.outcome, RoomOutcome::reached);
  EXPECT_LT(drive.goal_distance, 1);
  EXPECT_DOUBLE_EQ(drive.metric, 0.5) << "it takes less than two optimal times";
}

TEST(BarnScenarios, RefuseFilesOfAnotherFormat) {
  const testing::ScopedFolder folder;
  expect_error_with<std::runtime_error>({"world_0.world"}, [&] { barn_scenarios(folder.path(), 6); });
  folder.write("world_0.world", "<model name='unit_cylinder_1'> <pose frame=''>a");
  expect_error_with<std::runtime_error>({"world_0.world", "a number after <pose"},
                                        [&] { barn_scenarios(folder.path(), 6); });
  folder.write("world_0.world", cylinder(0, 0));
  std::filesystem::create_directory(folder.path() / "path_files");
  folder.write("path_files/path_0.npy", "1 2 3");
  expect_error_with<std::runtime_error>({"path_0.npy", "numpy"}, [&] { barn_scenarios(folder.path(), 6); });
}

}  // namespace
}  // namespace slalom::evaluation
