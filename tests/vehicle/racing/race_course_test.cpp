// Courses from maps: the loop that is found, dirt, directions, open lines, files.
#include "slalom/vehicle/racing/race_course.hpp"

#include "slalom/core/error.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/racing/rooms.hpp"

namespace slalom::vehicle::race_course_test {
namespace {

using maps::Occupancy;
using namespace testing;

class RaceCourseFile : public testing::TemporaryFolder {};

double signed_area(const std::vector<maps::Point>& line) {
  double sum = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const maps::Point &a = line[i], &b = line[(i + 1) % line.size()];
    sum += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return sum;
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

/// The course is the way round the rectangle.
void expect_rectangle(const RaceCourse& course) {
  EXPECT_TRUE(course.corridor.closed);
  EXPECT_NEAR(length(course.corridor), 45.5, 1.5);
  EXPECT_GT(least(course.distance), wall_distance(RacingCar{}, 2) - 0.02);
  for (std::size_t i = 0; i < course.corridor.left.size(); ++i) {
    const double width = course.corridor.left[i] + course.corridor.right[i];
    EXPECT_GT(width, 1.9) << i;
  }
}

TEST(RaceCourse, FindsTheLoopInTheMiddleOfTheCorridor) {
  const RaceCourse course = race_course(rectangular_course(), RacingCar{});
  expect_rectangle(course);
  // Beside the long sides the centre line is in the middle.
  for (const maps::Point& point : course.corridor.centre_line)
    if (point.x > 3 && point.x < 13) {
      EXPECT_NEAR(std::abs(point.y - 4), 4, 0.06);
    }
}

TEST(RaceCourse, TheLineUsesAllOfTheWidthAtAnyResolution) {
  // The same map at other scales, with a car whose distance to walls scales with it.
  for (const double resolution : {0.0431, 0.09585}) {
    maps::OccupancyGrid map = rectangular_course();
    const double scale = resolution / map.resolution;
    map.resolution = resolution;
    map.origin = {scale * map.origin.x, scale * map.origin.y, 0};
    const RacingCar car;
    const RaceCourse course = race_course(map, car);
    EXPECT_GE(least(course.distance), wall_distance(car, 2) - 0.005) << resolution;
    EXPECT_LE(least(course.distance), wall_distance(car, 2) + 0.01) << resolution;
  }
}

TEST(RaceCourse, StartsAtTheOriginOfTheMapFrameAlongX) {
  maps::OccupancyGrid map = rectangular_course();
  map.origin.x -= 8;  // the origin is in the middle of a long side
  const RaceCourse course = race_course(map, RacingCar{});
  EXPECT_EQ(course.start.x, 0);
  EXPECT_EQ(course.start.yaw, 0);
  EXPECT_NEAR(course.raceline.points[0].x, 0, 0.2);
  EXPECT_GT(signed_area(course.corridor.centre_line), 0);
  ASSERT_FALSE(course.notes.empty());
  EXPECT_NE(course.notes.back().find("origin of the map frame"), std::string::npos);
}

TEST(RaceCourse, DoesNotStartAtAnOriginThatFacesAWall) {
  maps::OccupancyGrid map = rectangular_course();
  map.origin = {map.origin.x, map.origin.y - 4, 0};  // the origin is in the left corridor, which runs along y
  const RaceCourse course = race_course(map, RacingCar{});
  EXPECT_NE(course.start.y, 0);
  const RacelinePoint& first = course.raceline.points[0];
  EXPECT_EQ(course.start.yaw, first.yaw);
  EXPECT_EQ(course.start.x, first.x);
}

TEST(RaceCourse, AStartPoseSetsPlaceAndDirection) {
  RaceCourseOptions options{.start = maps::Pose{8, 8, 0}};
  const RaceCourse course = race_course(rectangular_course(), RacingCar{}, options);
  EXPECT_LT(signed_area(course.corridor.centre_line), 0);
  EXPECT_NEAR(course.raceline.points[0].x, 8, 0.3);
  EXPECT_EQ(course.start.x, 8);
  options.reverse = true;
  EXPECT_THROW(race_course(rectangular_course(), RacingCar{}, options), std::invalid_argument);
  options.reverse = false;
  options.start = maps::Pose{8, 4, 0};
  EXPECT_THROW(race_course(rectangular_course(), RacingCar{}, options), std::invalid_argument);
}

TEST(RaceCourse, AStartOnACrossingIsOnThePartThatItFacesAlong) {
  GuideLine eight{{}, true};
  for (int i = 0; i < 120; ++i)
    eight.points.push_back(
        {8 * std::sin(2 * testing::pi * i / 120), 3.5 * std::sin(4 * testing::pi * i / 120)});
  maps::OccupancyGrid map = testing::unknown_map(20, 11, -10, -5.5);
  for (const auto& [half, cell] : {std::pair(1.1, Occupancy::occupied), {0.9, Occupancy::free}})
    for (const auto& [x, y] : eight.points) fill(map, x - half, y - half, x + half, y + half, cell);
  for (const double yaw : {0.7, 2.4, -0.7, -2.4}) {
    RaceCourseOptions options;
    options.start = maps::Pose{0, 0, yaw};
    const RaceCourse course = race_course(map, RacingCar{}, options, &eight);
    EXPECT_NEAR(maps::wrap_angle(course.raceline.points[0].yaw - yaw), 0, 0.4);
  }
}

TEST(RaceCourse, ReverseIsTheOtherWayRound) {
  maps::OccupancyGrid map = rectangular_course();
  map.origin.x -= 8;
  const RaceCourse course = race_course(map, RacingCar{}, {.start = {}, .reverse = true});
  EXPECT_LT(signed_area(course.corridor.centre_line), 0);
  EXPECT_NEAR(std::abs(course.start.yaw), testing::pi, 1e-9) << "the car stands at the origin, turned round";
}

TEST(RaceCourse, WithoutAStartItBeginsWhereItIsFast) {
  maps::OccupancyGrid map = rectangular_course();
  map.origin.x += 100;
  const RaceCourse course = race_course(map, RacingCar{});
  EXPECT_GT(signed_area(course.corridor.centre_line), 0);
  EXPECT_NEAR(course.raceline.points[0].speed, RacingCar{}.limits.top_speed, 1e-6);
  EXPECT_EQ(course.raceline.points[0].arc_length, 0);
  for (std::size_t i = 1; i < course.raceline.points.size(); ++i)
    EXPECT_GT(course.raceline.points[i].arc_length, course.raceline.points[i - 1].arc_length);
}

TEST(RaceCourse, UnknownSpotsInTheRoadAreFree) {
  maps::OccupancyGrid map = rectangular_course();
  for (int i = 0; i < 12; ++i) fill(map, 2 + i, -0.1, 2.1 + i, 0.1, Occupancy::unknown);
  const RaceCourse course = race_course(map, RacingCar{});
  expect_rectangle(course);
  EXPECT_NE(course.notes.front().find("12 unknown spots"), std::string::npos) << course.notes.front();
}

TEST(RaceCourse, HolesInWallsThatAreNarrowerThanTheCarAreClosed) {
  maps::OccupancyGrid map = rectangular_course();
  fill(map, 4, -3, 4.3, -1, Occupancy::free);       // through the outer wall to the border of the map
  fill(map, 8, 1, 8.3, 1.2, Occupancy::free);       // into the infield
  fill(map, 1.2, 1.2, 14.8, 6.8, Occupancy::free);  // which was seen
  expect_rectangle(race_course(map, RacingCar{}));
}

TEST(RaceCourse, RoomsBesideTheRoadAreNoWay) {
  maps::OccupancyGrid map = rectangular_course();
  // A door of 1 m in the inner wall, and a room with a table in it.
  fill(map, 1.2, 1.2, 14.8, 6.8, Occupancy::occupied);
  fill(map, 6, 1, 7, 2, Occupancy::free);
  fill(map, 4, 2, 10, 6, Occupancy::free);
  fill(map, 6, 3.5, 8, 4.5, Occupancy::occupied);
  const RaceCourse course = race_course(map, RacingCar{});
  EXPECT_NEAR(length(course.corridor), 45.5, 1.5);
  for (const maps::Point& point : course.corridor.centre_line)
    EXPECT_FALSE(point.x > 2 && point.x < 14 && point.y > 1.2 && point.y < 6.8) << point.x << " " << point.y;
}

TEST(RaceCourse, PassesWhatStandsInTheRoad) {
  maps::OccupancyGrid map = rectangular_course();
  fill(map, 8, -0.4, 8.5, 0.1, Occupancy::occupied);
  const RaceCourse course = race_course(map, RacingCar{});
  EXPECT_GT(least(course.distance), wall_distance(RacingCar{}, 2) - 0.02);
  EXPECT_NEAR(length(course.corridor), 45.5, 1.5);
}

TEST(RaceCourse, SurroundingsOfACourseThatIsDrawnAsOutlinesAreNoWay) {
  maps::OccupancyGrid map = testing::unknown_map(22, 14, -3, -3);
  fill(map, -3, -3, 20, 12, Occupancy::free);
  const maps::OccupancyGrid drawn = rectangular_course();
  for (std::size_t i = 0; i < map.cells.size(); ++i)
    if (drawn.cells[i] == Occupancy::occupied) map.cells[i] = Occupancy::occupied;
  expect_rectangle(race_course(map, RacingCar{}));
}

TEST(RaceCourse, SaysThatAMapHasNoLoop) {
  maps::OccupancyGrid map = rectangular_course();
  fill(map, 7, -1.2, 8, 1, Occupancy::occupied);
  expect_error_with<std::invalid_argument>({"no closed way"}, [&] { race_course(map, RacingCar{}); });
}

TEST(RaceCourse, AnOpenLineIsDrivenFromEndToEnd) {
  maps::OccupancyGrid map = rectangular_course();
  fill(map, -1.2, 3, 1.2, 3.5, Occupancy::occupied);
  const GuideLine guide{{{0, 2.5}, {0, 1}, {0.2, 0.1}, {2, 0}, {8, 0.2}, {14, 0}}, false};
  const RaceCourse course = race_course(map, RacingCar{}, {}, &guide);
  EXPECT_FALSE(course.corridor.closed);
  EXPECT_FALSE(course.raceline.closed);
  EXPECT_GT(least(course.distance), wall_distance(RacingCar{}, 2) - 0.02);
  EXPECT_NEAR(length(course.corridor), 15.6, 1);
  EXPECT_NEAR(course.start.y, 2.5, 0.5);
}

TEST(RaceCourse, MakesTheMapOfACorridor) {
  const RacingCar car;
  const RaceCourse course = race_course(testing::circle(6, 0.9), car);
  EXPECT_GT(least(course.distance), wall_distance(car, 1.8) - 0.08);
  const auto& map = course.map;
  const auto at = [&](double x, double y) {
    return map.at(static_cast<int>((x - map.origin.x) / map.resolution),
                  static_cast<int>((y - map.origin.y) / map.resolution));
  };
  EXPECT_EQ(at(6, 0), Occupancy::free);
  EXPECT_EQ(at(0, 6.8), Occupancy::free);
  EXPECT_EQ(at(0, 7.0), Occupancy::occupied);
  EXPECT_EQ(at(0, 0), Occupancy::unknown);
}

TEST(RaceCourse, SizesThatFollowFromLengthsHaveLimits) {
  const auto makes = [](const Corridor& corridor) { return message_of([&] { race_course(corridor, {}); }); };
  EXPECT_EQ(makes(testing::circle(5, 1000)),
            "corridor: walls 1000 m from the centre line; must be at most 33 m from it, to be drawn");
  EXPECT_NO_THROW(draw_corridor(testing::circle(5, 33), 0.0496, 0.1984));
  EXPECT_NE(makes(testing::circle(3000, 1)).find("corridor: 2 m wide; must be at least 3 m"),
            std::string::npos);
  // 20 km around, 20 m wide: the cells of its map are larger.
  const auto map = draw_corridor(testing::circle(3000, 10), 0.05, 0.2);
  EXPECT_LT(map.cells.size(), 2.6e7);
  EXPECT_LT(map.resolution, 1.4);
  const maps::OccupancyGrid fine{8, 8, 1e-3, {}, std::vector<Occupancy>(64, Occupancy::free)};
  EXPECT_NE(message_of([&] { race_course(fine, {}); }).find("map: the width of the car"), std::string::npos);
}

TEST_F(RaceCourseFile, JumpsInALineAreNamed) {
  const auto line = [&](int jump, double x, double y) {
    std::string text;
    for (int i = 0; i < 40; ++i)
      text += (i == jump ? std::to_string(x) + "," + std::to_string(y)
                         : std::to_string(0.1 * i) + "," + std::to_string(0.001 * i * i)) +
              "\n";
    return write("line.csv", text);
  };
  EXPECT_EQ(read_centre_line(line(-1, 0, 0)).line.points.size(), 40u);
  for (const auto& [jump, x, y] :
       {std::tuple{20, 0.0, 900.0}, {7, 1e6, 30.0}, {39, -50.0, 0.0}, {1, 0.0, 60.0}}) {
    const std::string place = "line.csv:" + std::to_string(jump + 1);
    expect_error_with<IoError>({place.c_str(), "jumps by"},
                               [&, jump = jump, x = x, y = y] { read_centre_line(line(jump, x, y)); });
  }
  expect_error_with<IoError>({"line.csv:8", "within 1e7 m"}, [&] { read_centre_line(line(7, 1e9, 0)); });
  // A straight of which only the ends are given is none.
  EXPECT_NO_THROW(
      read_centre_line(write("line.csv", "0,0\n0.1,0\n0.2,0\n0.3,0\n30,0\n30.1,0\n30.2,0.01\n30.3,0.02\n")));
}

TEST_F(RaceCourseFile, IsLoadedAsACourse) {
  const RaceCourse made = race_course(rectangular_course(), RacingCar{});
  save_race_course(made, folder_ / "course", {"room", "a \"room\"", "slalom course"});
  const Course course = load_course(folder_ / "course");
  EXPECT_EQ(course.name, "room");
  EXPECT_TRUE(course.closed);
  EXPECT_TRUE(course.notes.empty());
  EXPECT_NEAR(course.start.x, made.start.x, 1e-4);
  ASSERT_EQ(course.waypoints.size(), made.raceline.points.size());
  EXPECT_NEAR(profile_time(course), made.raceline.time, 1e-3);
  const CentreLineFile line = read_centre_line(folder_ / "course/centerline.csv");
  EXPECT_TRUE(line.line.closed);
  ASSERT_EQ(line.left.size(), made.corridor.left.size());
  EXPECT_NEAR(line.left[5], made.corridor.left[5], 1e-6);
  EXPECT_NEAR(line.right[5], made.corridor.right[5], 1e-6);
}

TEST_F(RaceCourseFile, CentreLinesHaveOneOfSeveralForms) {
  const auto read = [&](const std::string& text) { return read_centre_line(write("line.csv", text)); };
  const auto plain = read("0,0,1,2\n1,0,1,2\n1,1,1,2\n0,1,1,2\n0,0,1,2\n");
  EXPECT_EQ(plain.line.points.size(), 4u);
  EXPECT_TRUE(plain.line.closed);
  EXPECT_EQ(plain.right[0], 1);
  EXPECT_EQ(plain.left[0], 2);
  EXPECT_EQ(read("# x_m; y_m; w_tr_left_m; w_tr_right_m\n0;0;1;2\n1;0;1;2\n1;1;1;2\n0;1;1;2\n").left[0], 1);
  EXPECT_EQ(read("x_m,y_m,w_tr_right_m,w_tr_left_m\n0,0,1,2\n1,0,1,2\n1,1,1,2\n0,1,1,2\n").left[0], 2);
  EXPECT_TRUE(read("# x_m; y_m; vx_mps\n0;0;1\n1;0;1\n1;1;1\n0;1;1\n").left.empty());
  const auto open = read("0,0\n1,0\n2,0\n3,0\n4,0\n");
  EXPECT_FALSE(open.line.closed);
  EXPECT_TRUE(open.left.empty());
}

/// A line round a circle of 6 m, `points` apart in 100 parts of it, as x and y.
std::string circle(int points) {
  std::string text;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 100;
    text += std::to_string(6 * std::cos(angle)) + "," + std::to_string(6 * std::sin(angle)) + ",0.8,0.8\n";
  }
  return text;
}

TEST_F(RaceCourseFile, ALineThatOverlapsItsOwnStartIsClosedThere) {
  for (const int points : {100, 104, 107, 130, 180}) {
    const CentreLineFile read = read_centre_line(write("line.csv", circle(points)));
    EXPECT_TRUE(read.line.closed) << points;
    EXPECT_EQ(read.line.points.size(), 100u) << points;
    EXPECT_EQ(read.left.size(), 100u) << points;
    EXPECT_EQ(read.line.note.find("left out") != std::string::npos, points > 100) << read.line.note;
  }
  const CentreLineFile open = read_centre_line(write("line.csv", circle(60)));
  EXPECT_FALSE(open.line.closed);
  EXPECT_EQ(open.line.points.size(), 60u);
}

TEST(RaceCourse, SaysWhereTheWallsOfACentreLineCross) {
  std::vector<maps::Point> line;  // a hairpin, 1.2 m wide
  for (double x = 0; x < 5; x += 0.1) line.push_back({x, 0});
  for (double a = -1.5; a < 1.5; a += 0.1) line.push_back({5 + 0.6 * std::cos(a), 0.6 + 0.6 * std::sin(a)});
  for (double x = 5; x > 0; x -= 0.1) line.push_back({x, 1.2});
  const auto corridor = [&](double left) {
    const std::vector<double> widths(line.size(), left), outer(line.size(), 0.55);
    check_walls(corridor_from_widths(line, widths, outer, false, 0.1));
  };
  EXPECT_NO_THROW(corridor(0.55));
  expect_error_with<std::invalid_argument>({"walls cross", "(0.", "1.2"}, [&] { corridor(1.1); });
}

TEST(RaceCourse, ALineThatTurnsBackOnItselfIsNoCourse) {
  std::vector<maps::Point> line;
  for (int i = 0; i < 200; ++i) line.push_back({0.1 * std::abs(i - 100), 0});
  const std::vector<double> widths(line.size(), 1);
  for (const bool closed : {false, true})
    expect_error_with<std::invalid_argument>(
        {"walls cross"}, [&] { check_walls(corridor_from_widths(line, widths, widths, closed, 0.15)); });
}

TEST_F(RaceCourseFile, SaysWhatIsWrongInACentreLine) {
  const std::pair<const char*, std::vector<const char*>> cases[] = {
      {"0,0,1,1\n1,0,x,1\n", {"line.csv:2", "3 (width)", "'x'"}},
      {"0,0,1,1\n1,0,-1,1\n", {"line.csv:2", "within 0 to 1e7 m"}},
      {"0,0,1,1\n1\n", {"line.csv:2", "1 column"}},
      {"0,0,1,1\n1,0\n", {"line.csv:2", "as many"}},
      {"0,0,1,1\n1,0,1,1\n", {"line.csv", "at least 4"}}};
  for (const auto& [text, says] : cases) {
    SCOPED_TRACE(text);
    expect_error_with<IoError>(says, [&, text = text] { read_centre_line(write("line.csv", text)); });
  }
}

}  // namespace
}  // namespace slalom::vehicle::race_course_test
