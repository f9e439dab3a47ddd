// `slalom track`: the courses that ship are what their commands make; bad options are refused; results in
// JSON.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using testing::content;
using testing::run_program;

class TrackCommand : public testing::ProgramTest {
 protected:
  testing::Run track(const std::string& arguments) const { return program("track " + arguments); }
};

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
    const auto run = run_program(arguments + " --no-picture", folder_.string());
    ASSERT_EQ(run.status, 0) << run.output;
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
  const auto run = track("--seed 5 --length 40 --out new/course --json summary.json");
  ASSERT_EQ(run.status, 0) << run.output;
  for (const char* file :
       {"course.yaml", "map.yaml", "map.png", "raceline.csv", "opp_ref_path.csv", "picture.png"})
    EXPECT_TRUE(fs::exists(folder_ / "new/course" / file)) << file;
  const auto summary = nlohmann::json::parse(content(folder_ / "summary.json"));
  EXPECT_EQ(summary["seed"], 5);
  EXPECT_EQ(summary["name"], "course");
  EXPECT_EQ(summary["command"],
            "slalom track --seed 5 --length 40 --width 2.2 --character balanced --out course");
  const auto course = vehicle::load_course(folder_ / "new/course");
  EXPECT_NEAR(summary["length_m"].get<double>(), course.length, 0.2);
  EXPECT_NEAR(summary["profile_lap_s"].get<double>(), vehicle::profile_time(course), 0.1);
}

TEST_F(TrackCommand, QuotesRecordedArguments) {
  const auto run = track(
      "--length 40 --no-picture --out 'my course' --name \"the driver's\" --description 'a b' --json s.json");
  ASSERT_EQ(run.status, 0) << run.output;
  const auto command = nlohmann::json::parse(content(folder_ / "s.json"))["command"].get<std::string>();
  const std::string ending = " --name 'the driver'\\''s' --description 'a b' --out 'my course'";
  ASSERT_GT(command.size(), ending.size());
  EXPECT_EQ(command.substr(command.size() - ending.size()), ending);
  EXPECT_EQ(vehicle::load_course(folder_ / "my course").name, "the driver's");
}

TEST_F(TrackCommand, RejectsInvalidOptions) {
  struct Bad {
    const char *arguments, *says;
    int status;
  };
  const Bad all[] = {{"", "--out: is required", 2},
                     {"--out x --length 25 --width 3", "length", 2},
                     {"--out x --character furious", "furious", 2},
                     {"--out /proc/none/x", "/proc/none/x", 1}};
  for (const Bad& bad : all) {
    const auto run = track(bad.arguments);
    EXPECT_EQ(run.status, bad.status) << bad.arguments;
    EXPECT_NE(run.output.find(bad.says), std::string::npos) << bad.arguments << ": " << run.output;
  }
  EXPECT_FALSE(fs::exists(folder_ / "x")) << "nothing is written for bad options";
}

}  // namespace
}  // namespace slalom::tools
