// `slalom course` and `slalom track`: courses that the other commands can drive, and errors; the courses that
// ship are what their commands make, and can be lapped.

#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "tools/program_test.hpp"
#include "vehicle/racing/rooms.hpp"

namespace slalom::tools {
namespace {

class CourseCommand : public testing::ProgramTest {
 protected:
  void SetUp() override { maps::save_ros_map(testing::rectangular_course(), folder_ / "room.yaml"); }
  nlohmann::json summary() const { return result("s.json"); }
};

TEST_F(CourseCommand, MakesACourseFromAMapAlone) {
  succeed("course room.yaml --out made --json s.json");
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
  succeed("course room.yaml --out made --friction 0.4 --top-speed 5 --margin 0.15");
  succeed(
      "drive --course made --method mppi --config default_kinematic --set mppi.samples=1000 --json s.json");
  EXPECT_EQ(summary()["laps"][0]["collisions"], 0);
}

TEST_F(CourseCommand, TheCommandInCourseYamlMakesTheSameFiles) {
  succeed("course room.yaml --friction 0.7 --top-speed 6.5 --margin 0.1 --start 8,8,0 --out a");
  const std::string text = content(folder_ / "a/course.yaml"), key = "command: \"slalom ";
  const auto from = text.find(key) + key.size();
  const std::string command = text.substr(from, text.find("\"\n", from) - from);
  EXPECT_EQ(command, "course room.yaml --friction 0.7 --top-speed 6.5 --margin 0.1 --start 8,8,0 --out a");
  const std::string before = content(folder_ / "a/raceline.csv");
  fs::remove_all(folder_ / "a");
  succeed(command);
  EXPECT_EQ(content(folder_ / "a/raceline.csv"), before);
}

TEST_F(CourseCommand, ACentreLineWithWidthsNeedsNoMap) {
  succeed("course room.yaml --out made --json s.json");
  const auto first = summary();
  succeed("course made/centerline.csv --out again --json s.json");
  EXPECT_NEAR(summary()["profile_lap_s"].get<double>(), first["profile_lap_s"].get<double>(), 0.15);
  EXPECT_EQ(vehicle::load_course(folder_ / "again").waypoints.size() > 50, true);
}

TEST_F(CourseCommand, AnOpenLineMakesAnOpenCourse) {
  write("open.csv", "0,2,0.9,0.9\n0,0.5,0.9,0.9\n1,0,0.9,0.9\n3,0,0.9,0.9\n6,0.5,0.9,0.9\n9,0,0.9,0.9\n");
  for (const std::string arguments : {"open.csv", "room.yaml --line open.csv"}) {
    succeed("course " + arguments + " --out open --json s.json");
    EXPECT_EQ(summary()["closed"], false);
    EXPECT_FALSE(vehicle::load_course(folder_ / "open").closed);
  }
}

TEST_F(CourseCommand, ARecordedDriveIsALineToDriveAlong) {
  succeed(
      "drive --course wren --method mppi --config default_kinematic --set mppi.samples=500 --record "
      "lap.mcap");
  succeed("course '" SLALOM_COURSES "/wren/map.yaml' --line lap.mcap --out made --json s.json");
  EXPECT_EQ(summary()["closed"], true);
  EXPECT_NEAR(summary()["centre_line_length_m"].get<double>(), 34, 1.5);
}

TEST_F(CourseCommand, OneFileIsTheCarOfCoursePlannerAndSimulator) {
  write("wide.yaml",
        "base: default\nvehicle:\n  front_length: 0.2\n  rear_length: 0.2\n  body_front: 0.5\n  body_rear: "
        "0.1\n"
        "  body_width: 0.4\n  mass: 5\n  friction: 0.4\n");
  succeed("course room.yaml --car wide.yaml --top-speed 3 --out made --json s.json");
  const auto made = summary();
  EXPECT_EQ(made["car"], "wide");
  EXPECT_NEAR(made["car_curvature_per_m"].get<double>(), std::tan(0.4189) / 0.4, 1e-9);
  EXPECT_GT(made["min_clearance_m"].get<double>(), 0.04);
  succeed(
      "drive --course made --config wide.yaml --set samples=500 --set world.car=configured --json s.json "
      "--record lap.mcap");
  EXPECT_EQ(summary()["settings"]["options"]["world"]["friction"], 0.4) << "the floor is that of the file";
  EXPECT_EQ(summary()["laps"][0]["collisions"], 0);
}

TEST_F(CourseCommand, TheUnknownGreyOfAMapSaverIsNoWayOut) {
  // Beyond a gap in the wall of the room lies what nobody mapped.
  maps::OccupancyGrid map = testing::rectangular_course();
  for (auto& cell : map.cells)
    if (cell == maps::Occupancy::occupied) cell = maps::Occupancy::unknown;
  maps::save_ros_map(map, folder_ / "glass.yaml");
  std::string text = content(folder_ / "glass.yaml");
  text.replace(text.find("0.196"), 5, "0.25");
  write("glass.yaml", text);
  testing::expect_says(succeed("course glass.yaml --out made"),
                       {"note: glass.yaml: the grey 205 is read as unknown"});
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

class TrackCommand : public testing::ProgramTest {};

/// The text after `command: ` in a course.yaml of ours, without its quotes and the program's name.
std::string recorded_arguments(const fs::path& course_file) {
  std::istringstream lines(content(course_file));
  const std::string key = "command: \"slalom ";
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(key, 0) == 0) return line.substr(key.size(), line.size() - key.size() - 1);
  return {};
}

TEST_F(TrackCommand, MakesTheShippedCoursesAgain) {
  const auto names = vehicle::course_names({SLALOM_COURSES});
  ASSERT_GE(names.size(), 6u);
  for (const auto& name : names) {
    const fs::path shipped = fs::path(SLALOM_COURSES) / name, made = folder_ / name;
    const std::string arguments = recorded_arguments(shipped / "course.yaml");
    ASSERT_FALSE(arguments.empty()) << name;
    succeed(arguments + " --no-picture");
    for (const char* file : {"course.yaml", "map.yaml", "raceline.csv", "opp_ref_path.csv"})
      EXPECT_TRUE(content(shipped / file) == content(made / file)) << name << "/" << file << " differs";
    // The PNG library decides how the bytes are packed, so the pixels are compared.
    EXPECT_TRUE(maps::load_ros_map(shipped / "map.yaml").cells == maps::load_ros_map(made / "map.yaml").cells)
        << name;
  }
}

TEST_F(TrackCommand, ShippedCoursesAreValid) {
  for (const auto& name : vehicle::course_names({SLALOM_COURSES})) {
    const vehicle::Course course = vehicle::load_course(fs::path(SLALOM_COURSES) / name);
    EXPECT_EQ(course.name, name);
    EXPECT_FALSE(course.description.empty()) << name;
    EXPECT_TRUE(course.closed) << name;
    EXPECT_TRUE(course.notes.empty()) << name;
    EXPECT_NO_THROW(vehicle::check_start(course, course.start, 0.4)) << name;
    EXPECT_NEAR(maps::wrap_angle(course.start.yaw - course.waypoints.front().yaw), 0, 0.05) << name;
  }
}

TEST_F(TrackCommand, WritesEveryFileAndASummary) {
  succeed("track --seed 5 --length 40 --out new/course --json summary.json");
  for (const char* file :
       {"course.yaml", "map.yaml", "map.png", "raceline.csv", "opp_ref_path.csv", "picture.png"})
    EXPECT_TRUE(fs::exists(folder_ / "new/course" / file)) << file;
  const auto summary = result("summary.json");
  EXPECT_EQ(summary["seed"], 5);
  EXPECT_EQ(summary["name"], "course");
  EXPECT_EQ(summary["command"],
            "slalom track --seed 5 --length 40 --width 2.2 --character balanced --out course");
  const auto course = vehicle::load_course(folder_ / "new/course");
  EXPECT_NEAR(summary["length_m"].get<double>(), course.length, 0.2);
  EXPECT_NEAR(summary["profile_lap_s"].get<double>(), vehicle::profile_time(course), 0.1);
}

TEST_F(TrackCommand, QuotesRecordedArguments) {
  succeed(
      "track --length 40 --no-picture --out 'my course' --name \"the driver's\" --description 'a b' "
      "--json s.json");
  const auto command = result("s.json")["command"].get<std::string>();
  const std::string ending = " --name 'the driver'\\''s' --description 'a b' --out 'my course'";
  ASSERT_GT(command.size(), ending.size());
  EXPECT_EQ(command.substr(command.size() - ending.size()), ending);
  EXPECT_EQ(vehicle::load_course(folder_ / "my course").name, "the driver's");
}

TEST_F(TrackCommand, RejectsInvalidOptions) {
  expect_refused("track", {"--out: is required"}, 2);
  expect_refused("track --out x --length 25 --width 3", {"length"}, 2);
  expect_refused("track --out x --character furious", {"furious"}, 2);
  expect_refused("track --out /proc/none/x", {"/proc/none/x"}, 1);
  EXPECT_FALSE(fs::exists(folder_ / "x")) << "nothing is written for bad options";
}

TEST(ShippedCourse, CanBeLappedAtItsOwnProfile) {
  for (const auto& name : vehicle::course_names({SLALOM_COURSES})) {
    const vehicle::Course course = vehicle::load_course(std::filesystem::path(SLALOM_COURSES) / name);
    std::vector<sim::PathPoint> path;
    std::vector<maps::Point> line;
    for (const auto& point : course.waypoints) {
      path.push_back({{point.x, point.y}, point.speed});
      line.push_back({point.x, point.y});
    }
    const sim::PurePursuit pursuit(path, {.lookahead = 0.9});
    sim::WorldOptions options;
    options.car.width += 2 * 0.15;  // the distance that the body must keep from the walls, m
    sim::World world(options, std::make_shared<const sim::Track>(course.map, sim::LapPath(line)));
    world.reset(1, std::vector{course.start});
    const double limit = 3 * vehicle::profile_time(course);
    double largest_error = 0;
    while (world.laps(0)->progress() < course.length && world.time() < limit) {
      const maps::Pose pose = world.observe(0).pose;
      largest_error = std::max(largest_error, pursuit.nearest({pose.x, pose.y}).distance);
      world.step(std::vector{pursuit.command(pose)});
      ASSERT_FALSE(world.observe(0).collides()) << name << " after " << world.time() << " s";
    }
    EXPECT_LT(world.time(), limit) << name;
    EXPECT_LT(largest_error, 0.15) << name;
  }
}

}  // namespace
}  // namespace slalom::tools
