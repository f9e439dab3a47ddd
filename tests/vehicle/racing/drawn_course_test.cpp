// Courses as people draw them: lines without walls or beside the map, eights, gaps, roads without a margin.

#include "slalom/vehicle/racing/race_course.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/racing/rooms.hpp"

namespace slalom::vehicle::drawn_course_test {
namespace {

using maps::Occupancy;
using namespace testing;

/// Points of a closed curve, whose parameter goes once round.
std::vector<maps::Point> curve(const std::function<maps::Point(double)>& at) {
  std::vector<maps::Point> points;
  for (int i = 0; i < 150; ++i) points.push_back(at(2 * pi * i / 150));
  return points;
}

/// A road of this half width (m) along a curve within 11 m of the origin.
maps::OccupancyGrid road(const std::vector<maps::Point>& line, double half_width) {
  maps::OccupancyGrid map = testing::unknown_map(24, 24, -12, -12);
  for (const bool free : {false, true})
    for (const maps::Point& point : line)
      for (double x = -1.2; x < 1.2; x += 0.04)
        for (double y = -1.2; y < 1.2; y += 0.04)
          if (std::hypot(x, y) < half_width + (free ? 0 : 0.15))
            map.at(static_cast<int>((point.x + x + 12) / 0.05), static_cast<int>((point.y + y + 12) / 0.05)) =
                free ? Occupancy::free : Occupancy::occupied;
  return map;
}

bool says(const RaceCourse& course, const std::string& words) {
  for (const std::string& note : course.notes)
    if (note.find(words) != std::string::npos) return true;
  return false;
}

TEST(DrawnCourse, ALineThatIsNotOnTheMapIsRefused) {
  const auto makes = [](double scale, double by) {
    GuideLine guide{{{0, 0}, {15, 0.2}, {15.5, 8}, {7, 8}, {0, 7.5}}};
    for (maps::Point& point : guide.points) point = {scale * point.x + by, scale * point.y};
    return message_of([&] { race_course(rectangular_course(), RacingCar{}, {}, &guide); });
  };
  EXPECT_EQ(makes(1, 0), "accepted");
  EXPECT_EQ(makes(1, 20),
            "line: 0 of its 5 points are in free space of the map; it reaches from (20.00, 0.00) to (35.50, "
            "8.00), and the map from (-2.98, -2.98) to (18.98, 10.98)");
  for (const double scale : {0.0, 1e-12, 1e-3, 1e5})
    for (const double by : {0.0, 4.0, 16.0, 1e6})
      EXPECT_NE(makes(scale, by), "accepted") << scale << " " << by;
}

TEST(DrawnCourse, WhereNothingBoundsTheRoadTheLineIsKept) {
  maps::OccupancyGrid map = testing::unknown_map(24, 24, -12, -12);
  testing::fill(map, -12, -12, 12, 12, Occupancy::free);
  const GuideLine oval{curve([](double a) { return maps::Point{6 * std::cos(a), 3.5 * std::sin(a)}; })};
  const RaceCourse course = race_course(map, RacingCar{}, {}, &oval);
  EXPECT_NEAR(course.raceline.length, 30.3, 0.6);
  EXPECT_TRUE(course.notes.empty());
  for (const RacelinePoint& point : course.raceline.points)
    EXPECT_NEAR(std::hypot(point.x / 6, point.y / 3.5), 1, 0.03);
  const GuideLine zigzag{curve([](double a) {
    const double radius = 5 + 0.5 * std::sin(25 * a);
    return maps::Point{radius * std::cos(a), radius * std::sin(a)};
  })};
  EXPECT_TRUE(says(race_course(road(curve([](double a) {
                                      return maps::Point{5 * std::cos(a), 5 * std::sin(a)};
                                    }),
                                    1.1),
                               RacingCar{}, {}, &zigzag),
                   "m long, and the line"));
}

TEST(DrawnCourse, LoopsThatRankAlikeAreADoubtThatALineResolves) {
  const auto eight = curve([](double a) { return maps::Point{10 * std::sin(a), 4.2 * std::sin(2 * a)}; });
  const maps::OccupancyGrid map = road(eight, 0.9);
  EXPECT_TRUE(says(race_course(map, RacingCar{}), "another loop, through ("));
  const GuideLine line{eight};
  const RaceCourse whole = race_course(map, RacingCar{}, {}, &line);
  EXPECT_NEAR(whole.raceline.length, length({eight, {}, {}, {}, true}), 3);
  EXPECT_TRUE(whole.notes.empty());
  EXPECT_TRUE(race_course(rectangular_course(), RacingCar{}).notes.empty());
}

TEST(DrawnCourse, AGapThatIsMuchNarrowerThanTheRoadIsADoubt) {
  maps::OccupancyGrid map = rectangular_course();
  map.origin.x += 100;
  testing::fill(map, 107, -1, 108, 0.45, Occupancy::occupied);
  EXPECT_TRUE(says(race_course(map, RacingCar{}), "leads through a gap of 0.5"));
  expect_error_with<std::invalid_argument>({"no closed way"}, [&] {
    race_course(map, RacingCar{}, {.start = {}, .reverse = false, .narrowest = 1});
  });
}

TEST(DrawnCourse, WithoutAMarginTheCarStartsInTheMiddleOfTheRoad) {
  RacingCar car{.margin = 0};
  const auto ring = curve([](double a) { return maps::Point{6 * std::cos(a), 6 * std::sin(a)}; });
  const RaceCourse course = race_course(road(ring, 0.45), car);
  EXPECT_NEAR(std::hypot(course.raceline.points[0].x, course.raceline.points[0].y), 5.7, 0.06);
  EXPECT_NEAR(std::hypot(course.start.x, course.start.y), 6, 0.1);
}

}  // namespace
}  // namespace slalom::vehicle::drawn_course_test
