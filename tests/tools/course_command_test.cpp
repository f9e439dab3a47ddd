// `slalom course`: courses from maps, centre lines and recordings that the other commands can drive; errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "tools/program_test.hpp"
#include "vehicle/racing/rooms.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using testing::content;

class CourseCommand : public testing::ProgramTest {
 protected:
  void SetUp() override { maps::save_ros_map(testing::rectangular_course(), folder_ / "room.yaml"); }
  testing::Run course(const std::string& arguments) const { return program("course " + arguments); }
  nlohmann::json summary() const { return nlohmann::json::parse(content(folder_ / "s.json")); }
};

TEST_F(CourseCommand, MakesACourseFromAMapAlone) {
  const auto run = course("room.yaml --out made --json s.json");
  ASSERT_EQ(run.status, 0) << run.output;
  for (const char* file :
       {"course.yaml", "map.yaml", "map.png", "raceline.csv", "centerline.csv", "picture.png"})
    EXPECT_TRUE(fs::exists(folder_ / "made" / file)) << file;
  const auto said = summary();
  const auto loaded = vehicle::load_course(folder_ / "made");
  EXPECT_TRUE(loaded.notes.empty());
  EXPECT_NEAR(said["profile_lap_s"].get<double>(), vehicle::profile_time(loaded), 1e-3);
  EXPECT_NEAR(said["length_m"].get<double>(), loaded.length, 1e-3);
  EXPECT_GT(said["min_clearance_m"].get<double>(), 0.04);
  EXPECT_LE(said["max_curvature_per_m"].get<double>(), said["car_curvature_per_m"].get<double>());
  EXPECT_TRUE(maps::load_ros_map(folder_ / "made/map.yaml").cells == testing::rectangular_course().cells);
}

TEST_F(CourseCommand, ItsCourseIsDrivenWithoutCollision) {
  // A friction that leaves room for the tyres of the simulator.
  ASSERT_EQ(course("room.yaml --out made --friction 0.4 --top-speed 5 --margin 0.15").status, 0);
  const auto run = program(
      "drive --course made --method mppi --config default_kinematic --set mppi.samples=1000 --json s.json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(summary()["laps"][0]["contacts"], 0);
}

TEST_F(CourseCommand, TheCommandInCourseYamlMakesTheSameFiles) {
  ASSERT_EQ(course("room.yaml --friction 0.7 --top-speed 6.5 --margin 0.1 --start 8,8,0 --out a").status, 0);
  const std::string text = content(folder_ / "a/course.yaml"), key = "command: \"slalom ";
  const auto from = text.find(key) + key.size();
  const std::string command = text.substr(from, text.find("\"\n", from) - from);
  EXPECT_EQ(command, "course room.yaml --friction 0.7 --top-speed 6.5 --margin 0.1 --start 8,8,0 --out a");
  const std::string before = content(folder_ / "a/raceline.csv");
  fs::remove_all(folder_ / "a");
  ASSERT_EQ(program(command).status, 0);
  EXPECT_EQ(content(folder_ / "a/raceline.csv"), before);
}

TEST_F(CourseCommand, ACentreLineWithWidthsNeedsNoMap) {
  ASSERT_EQ(course("room.yaml --out made --json s.json").status, 0);
  const auto first = summary();
  const auto run = course("made/centerline.csv --out again --json s.json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NEAR(summary()["profile_lap_s"].get<double>(), first["profile_lap_s"].get<double>(), 0.15);
  EXPECT_EQ(vehicle::load_course(folder_ / "again").waypoints.size() > 50, true);
}

TEST_F(CourseCommand, AnOpenLineMakesAnOpenCourse) {
  write("open.csv", "0,2,0.9,0.9\n0,0.5,0.9,0.9\n1,0,0.9,0.9\n3,0,0.9,0.9\n6,0.5,0.9,0.9\n9,0,0.9,0.9\n");
  for (const std::string arguments : {"open.csv", "room.yaml --line open.csv"}) {
    const auto run = course(arguments + " --out open --json s.json");
    ASSERT_EQ(run.status, 0) << run.output;
    EXPECT_EQ(summary()["closed"], false);
    EXPECT_FALSE(vehicle::load_course(folder_ / "open").closed);
  }
}

TEST_F(CourseCommand, ARecordedDriveIsALineToDriveAlong) {
  ASSERT_EQ(program("drive --course wren --method mppi --config default_kinematic --set mppi.samples=500 "
                    "--record lap.mcap")
                .status,
            0);
  const std::string map = SLALOM_COURSES "/wren/map.yaml";
  const auto run = course("'" + map + "' --line lap.mcap --out made --json s.json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(summary()["closed"], true);
  EXPECT_NEAR(summary()["centre_line_length_m"].get<double>(), 34, 1.5);
}

TEST_F(CourseCommand, OneFileIsTheCarOfCoursePlannerAndSimulator) {
  write("wide.yaml",
        "base: default\nvehicle:\n  front_length: 0.2\n  rear_length: 0.2\n  body_front: 0.5\n  body_rear: "
        "0.1\n"
        "  body_width: 0.4\n  mass: 5\n  friction: 0.4\n");
  ASSERT_EQ(course("room.yaml --car wide.yaml --top-speed 3 --out made --json s.json").status, 0);
  const auto made = summary();
  EXPECT_EQ(made["car"], "wide");
  EXPECT_NEAR(made["car_curvature_per_m"].get<double>(), std::tan(0.4189) / 0.4, 1e-9);
  EXPECT_GT(made["min_clearance_m"].get<double>(), 0.04);
  const auto run = program(
      "drive --course made --config wide.yaml --set samples=500 --set world.car=configured --json s.json "
      "--record lap.mcap");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(summary()["settings"]["options"]["world"]["friction"], 0.4) << "the floor is that of the file";
  EXPECT_EQ(summary()["laps"][0]["contacts"], 0);
}

TEST_F(CourseCommand, TheUnknownGreyOfAMapSaverIsNoWayOut) {
  // Beyond a gap in the wall of the room lies what nobody mapped.
  maps::OccupancyGrid map = testing::rectangular_course();
  for (auto& cell : map.cells)
    if (cell == maps::Occupancy::occupied) cell = maps::Occupancy::unknown;
  maps::save_ros_map(map, folder_ / "glass.yaml");
  std::string text = content(folder_ / "glass.yaml");
  text.replace(text.find("0.196"), 5, "0.25");
  std::ofstream(folder_ / "glass.yaml") << text;
  const auto run = course("glass.yaml --out made --json s.json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("note: glass.yaml: the grey 205 is read as unknown"), std::string::npos)
      << run.output;
  const auto drawn = vehicle::load_course(folder_ / "made").map;
  for (std::size_t i = 0; i < drawn.cells.size(); ++i)
    EXPECT_EQ(drawn.cells[i] == maps::Occupancy::free, map.cells[i] == maps::Occupancy::free);
}

TEST_F(CourseCommand, SaysWhatIsWrong) {
  write("points.csv", "0,0\n1,0\n2,0\n3,1\n");
  expect_refused("course", {"input: is required"});
  expect_refused("course room.yaml", {"--out: is required"});
  expect_refused("course none.yaml --out x", {"none.yaml"});
  expect_refused("course room.yaml --out x --car tank", {"--car", "tank", "default"});
  expect_refused("course room.yaml --out x --car passenger",
                 {"room.yaml", "no closed way", "m from all walls"});
  expect_refused("course room.yaml --out x --start 8,4,0",
                 {"room.yaml", "start: (8.00, 4.00)", "free space"});
  expect_refused("course room.yaml --out x --start 8", {"--start", "x,y,yaw"});
  expect_refused("course room.yaml --out x --start 8,8,0 --reverse", {"--reverse", "--start"});
  expect_refused("course points.csv --out x", {"points.csv", "no widths", "--line"});
  expect_refused("course points.csv --line points.csv --out x", {"--line", "needs a map"});
  EXPECT_FALSE(fs::exists(folder_ / "x")) << "nothing is written";
}

}  // namespace
}  // namespace slalom::tools
