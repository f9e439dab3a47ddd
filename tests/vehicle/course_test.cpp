// The content of a sound course after loading, and how courses are found.
#include "slalom/vehicle/course/course.hpp"

#include <cstdlib>

#include "slalom/core/error.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/course_folder.hpp"

namespace slalom::vehicle::course_test {
namespace {

using testing::CourseFolder;
constexpr double pi = 3.14159265358979323846;

TEST(Course, ReadsTheRacelineForm) {
  const CourseFolder folder;
  const Course course = load_course(folder.path());
  ASSERT_EQ(course.waypoints.size(), 4u);
  EXPECT_EQ(course.name, "ring");
  EXPECT_TRUE(course.closed);
  EXPECT_NEAR(course.length, 8 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(course.waypoints[0].yaw, 0.75 * pi, 1e-12) << "from the points, not from psi_rad";
  EXPECT_NEAR(course.waypoints[3].yaw, course.waypoints[2].yaw, 1e-12);
  EXPECT_NEAR(course.waypoints[2].arc_length, 4 * std::sqrt(2.0), 1e-12);
  EXPECT_DOUBLE_EQ(course.waypoints[1].speed, 2);
  EXPECT_DOUBLE_EQ(course.start.x, 2);
  EXPECT_DOUBLE_EQ(course.start.yaw, course.waypoints[0].yaw);
  EXPECT_EQ(course.obstacle_path.size(), 4u);
  EXPECT_TRUE(course.notes.empty());
  EXPECT_FALSE(course.timeout.has_value());
}

TEST(Course, ReadsTheOptimisedLineForm) {
  const CourseFolder folder;
  folder.remove("raceline.csv");
  folder.write("line.csv",
               "opt_x,opt_y,width,ref_v\r\n1,0,9,1.5\r\n0,1,9,2.5\r\n-1,0,9,3.5\r\n1,0,9,1.5\r\n");
  const Course course = load_course(folder.path());
  ASSERT_EQ(course.waypoints.size(), 3u) << "the last row repeats the first and is dropped";
  EXPECT_DOUBLE_EQ(course.waypoints[2].x, -1);
  EXPECT_DOUBLE_EQ(course.waypoints[1].speed, 2.5);
}

TEST(Course, ReadsPointsWithSpeedsWhereThereIsNothingElse) {
  const CourseFolder folder;
  folder.write("points.csv", "# x_m; y_m; vx_mps\n2; 0; 1.5\n0; 2; 2.5\n-2; 0; 3\n0; -2; 0\n");
  EXPECT_EQ(load_course(folder.path()).waypoints[1].speed, 2) << "of the raceline";
  folder.remove("raceline.csv");
  for (const char* text : {"# x_m; y_m; vx_mps\n2; 0; 1.5\n0; 2; 2.5\n-2; 0; 3\n0; -2; 0\n",
                           "x,y,v\n2,0,1.5\n0,2,2.5\n-2,0,3\n0,-2,0\n"}) {
    folder.write("points.csv", text);
    const Course course = load_course(folder.path());
    ASSERT_EQ(course.waypoints.size(), 4u);
    EXPECT_EQ(course.waypoints[1].y, 2);
    EXPECT_EQ(course.waypoints[1].speed, 2.5);
  }
}

TEST(Course, NotesFilesThatItIgnoresButForACentreLine) {
  const CourseFolder folder;
  folder.write("centre.csv", "# x_m, y_m, w_tr_right_m, w_tr_left_m\n0, 0, 1, 1\n");
  folder.write("times.csv", "lap, s\n1, 12.5\n");
  folder.write("planner.yaml", "samples: 5\n");
  const Course course = load_course(folder.path());
  ASSERT_EQ(course.notes.size(), 2u);
  EXPECT_NE((course.notes[0] + course.notes[1]).find("times.csv"), std::string::npos);
  EXPECT_NE((course.notes[0] + course.notes[1]).find("planner.yaml"), std::string::npos);
}

TEST(Course, TakesObstaclePathStartAndTimeoutFromItsFiles) {
  const CourseFolder folder;
  folder.write("opp_ref_path.csv", "1,2,77\n3,4\n");
  folder.write("course.yaml",
               "name: Ring\ndescription: round\ncommand: x\nstart: {x: 1, y: 2, yaw: 0.5}\ntimeout: "
               "9\nclosed: false\n");
  const Course course = load_course(folder.path());
  ASSERT_EQ(course.obstacle_path.size(), 2u);
  EXPECT_DOUBLE_EQ(course.obstacle_path[1].y, 4);
  EXPECT_EQ(course.name, "Ring");
  EXPECT_EQ(course.description, "round");
  EXPECT_DOUBLE_EQ(course.start.yaw, 0.5);
  EXPECT_DOUBLE_EQ(course.timeout.value(), 9);
  EXPECT_FALSE(course.closed);
  EXPECT_NEAR(course.length, 6 * std::sqrt(2.0), 1e-12);
}

TEST(Course, IsOpenWhereItsEndsAreFarApart) {
  const CourseFolder folder;
  folder.write("raceline.csv", "0;0;0;0;0;1;0\n1;1;0;0;0;1;0\n2;2;0;0;0;1;0\n3;3;0;0;0;1;0\n4;4;0;0;0;1;0\n");
  const Course course = load_course(folder.path());
  EXPECT_FALSE(course.closed);
  EXPECT_DOUBLE_EQ(course.length, 4);
  EXPECT_DOUBLE_EQ(profile_time(course), 4);
}

TEST(Course, IsCompletedFromItsPoints) {
  Course course;
  for (const double at : {0.0, 0.5, 1.0, 1.5})
    course.waypoints.push_back({std::cos(pi * at), std::sin(pi * at), 0, 1, 0});
  complete_course(course);
  EXPECT_TRUE(course.closed);
  EXPECT_NEAR(course.length, 4 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(course.start.yaw, 0.75 * pi, 1e-12);
  EXPECT_EQ(course.obstacle_path.size(), 4u);
  complete_course(course, false);
  EXPECT_FALSE(course.closed);
  EXPECT_NEAR(course.length, 3 * std::sqrt(2.0), 1e-12);
  course.waypoints.resize(2);
  EXPECT_THROW(complete_course(course), std::invalid_argument);
}

TEST(Course, CapsSpeedsAndReturnsTheTimeOfTheProfile) {
  const CourseFolder folder;
  Course course = load_course(folder.path());
  const double step = 2 * std::sqrt(2.0);
  EXPECT_NEAR(profile_time(course), step / 1.5 + step / 2.5 + step / 3.5 + step / 2.5, 1e-12);
  cap_speed(course, 2);
  EXPECT_DOUBLE_EQ(course.waypoints[0].speed, 1);
  EXPECT_DOUBLE_EQ(course.waypoints[3].speed, 2);
  EXPECT_THROW(cap_speed(course, 0), std::invalid_argument);
  EXPECT_THROW(cap_speed(course, std::nan("")), std::invalid_argument);
}

TEST(Course, RejectsAStartInAWallOffTheMapOrNotFinite) {
  const CourseFolder folder;
  const Course course = load_course(folder.path());
  EXPECT_NO_THROW(check_start(course, {0, 0, 1}));
  EXPECT_NO_THROW(check_start(course, {4.7, 0, 0}));
  EXPECT_THROW(check_start(course, {4.85, 0, 0}), std::invalid_argument)
      << "0.1 m from the centre of a wall cell";
  EXPECT_THROW(check_start(course, {4.95, 0, 0}), std::invalid_argument) << "in the wall";
  EXPECT_THROW(check_start(course, {5.1, 0, 0}), std::invalid_argument) << "off the map";
  EXPECT_THROW(check_start(course, {0, 0, INFINITY}), std::invalid_argument);
}

TEST(CourseSearch, FindsFoldersAndNames) {
  const CourseFolder folder;
  const auto root = folder.path().parent_path();
  EXPECT_EQ(find_course(folder.path().string(), {}), folder.path());
  EXPECT_EQ(find_course("ring", {root / "absent", root}), folder.path());
  EXPECT_EQ(course_names({root, root}), std::vector<std::string>{"ring"});
  expect_error_with<IoError>({"known: ring"}, [&] { find_course("rung", {root}); });
  EXPECT_THROW(find_course("", {root}), IoError);
}

TEST(CourseSearch, LooksBesideTheProgram) {
  const CourseFolder folder;
  const auto tree = folder.path().parent_path();
  for (const char* made : {"courses", "build/release/bin", "usr/bin", "usr/share/slalom/courses", "mine"})
    std::filesystem::create_directories(tree / made);
  folder.write("../courses/known.yaml", "berlin: {start: {x: 0, y: 0, yaw: 3.14}, timeout: 50}\n");
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the test has one thread.
  unsetenv("SLALOM_COURSES_DIR");
  const auto canonical = std::filesystem::weakly_canonical(tree);
  EXPECT_EQ(course_roots(tree / "build/release/bin").front(), canonical / "courses");
  EXPECT_EQ(course_roots(tree / "usr/bin").back(), canonical / "usr/share/slalom/courses");
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the test has one thread.
  setenv("SLALOM_COURSES_DIR", (tree / "mine").c_str(), 1);
  EXPECT_EQ(course_roots(tree / "build/release/bin").front(), tree / "mine");
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the test has one thread.
  unsetenv("SLALOM_COURSES_DIR");

  const auto berlin = known_course("berlin", {tree / "mine", tree / "courses"});
  ASSERT_TRUE(berlin.has_value());
  EXPECT_DOUBLE_EQ(berlin->start.yaw, 3.14);
  EXPECT_DOUBLE_EQ(berlin->timeout, 50);
  EXPECT_FALSE(known_course("paris", {tree / "courses"}).has_value());
  EXPECT_FALSE(known_course("berlin", {tree / "mine"}).has_value());
}

/// The courses that the paper and its peers drive, where their folder is at hand.
struct OutsideCourse {
  const char* name;
  std::size_t waypoints;
  double length, top_speed;
};

class ExternalCourse : public ::testing::TestWithParam<OutsideCourse> {};

TEST_P(ExternalCourse, Loads) {
  const char* root = std::getenv("SLALOM_DATA_DIR");
  if (!root || !std::filesystem::exists(std::filesystem::path(root) / GetParam().name))
    GTEST_SKIP() << "set SLALOM_DATA_DIR to a folder that has " << GetParam().name;
  const Course course = load_course(std::filesystem::path(root) / GetParam().name);
  EXPECT_EQ(course.waypoints.size(), GetParam().waypoints);
  EXPECT_NEAR(course.length, GetParam().length, 0.05);
  EXPECT_TRUE(course.closed);
  double top = 0;
  for (const Waypoint& point : course.waypoints) top = std::max(top, point.speed);
  EXPECT_NEAR(top, GetParam().top_speed, 0.01);
  EXPECT_NO_THROW(check_start(course, course.start, 0.0));
}

INSTANTIATE_TEST_SUITE_P(Courses, ExternalCourse,
                         ::testing::Values(OutsideCourse{"berlin", 1362, 59.80, 6.082},
                                           OutsideCourse{"oschersleben", 1252, 250.28, 8.0},
                                           OutsideCourse{"spielberg", 1228, 338.05, 20.0}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Course, AGapOfAClosedCourseIsFilled) {
  Course course;
  for (double a = 0; a < 5.5; a += 0.1)
    course.waypoints.push_back({10 * std::cos(a), 10 * std::sin(a), 0, a});
  Course open = course;
  complete_course(open);
  EXPECT_FALSE(open.closed);
  const std::size_t before = course.waypoints.size();
  complete_course(course, true);
  EXPECT_GT(course.waypoints.size(), before);
  std::vector<maps::Point> points;
  for (const Waypoint& point : course.waypoints) points.push_back({point.x, point.y});
  EXPECT_TRUE(path_geometry(points).closed) << "as a planner sees it, which knows only the points";
}

}  // namespace
}  // namespace slalom::vehicle::course_test
