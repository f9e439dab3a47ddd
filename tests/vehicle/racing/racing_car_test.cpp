// Cars: profiles, configurations.
// Courses as people draw them: lines without walls or beside the map, eights, gaps, roads without a margin.
#include "slalom/vehicle/racing/racing_car.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/racing/rooms.hpp"

namespace slalom::vehicle::racing_car_test {
namespace {

TEST(RacingSpeeds, AreInsideTheEllipseThroughoutAndNearFeasibleSpeeds) {
  RacingCar car{.max_steering_rate = 1e9, .limits = {7, 5, 3, 4}};
  constexpr std::size_t count = 300;
  std::vector<double> curvature, step;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<double>(i);
    curvature.push_back(0.8 * std::sin(0.07 * at) * std::sin(0.013 * at));
    step.push_back(0.1 + 0.05 * std::cos(at));
  }
  const auto most_used = [&](const std::vector<double>& speeds, bool closed) {
    double most = 0;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i) {
      const std::size_t next = (i + 1) % count;
      const double v = speeds[i], w = speeds[next], along = (w * w - v * v) / (2 * step[i]);
      const double strongest = along > 0 ? car.limits.acceleration : car.limits.braking;
      const auto used = [&](double speed, double k) {
        return std::hypot(speed * speed * k / car.limits.lateral_acceleration, along / strongest);
      };
      most = std::max({most, used(v, curvature[i]), used(w, curvature[next]),
                       used(0.5 * (v + w), 0.5 * (curvature[i] + curvature[next]))});
    }
    return most;
  };
  for (const bool closed : {true, false}) {
    const auto speeds = racing_speeds(curvature, step, closed, car);
    const auto others = feasible_speeds(std::vector<double>(count, 7), curvature, step, closed, car.limits);
    EXPECT_LT(most_used(speeds, closed), 1 + 1e-9);
    EXPECT_GT(most_used(others, closed), 1.05) << "the limits of the begin of a piece are not enough";
    for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(speeds[i], others[i], 0.01 * others[i]) << i;
  }
}

TEST(RacingSpeeds, PowerLimitsTheGainOfEnergy) {
  // One slow point on a straight: the kinetic energy per mass, v^2 / 2, grows by power in time.
  RacingCar car{.max_steering_rate = 1e9, .limits = {60, 9, 9, 9}, .power = 40};
  std::vector<double> curvature(4000, 0.0), step(4000, 0.05);
  curvature[0] = 9;
  const auto v = racing_speeds(curvature, step, false, car);
  double time = 0;
  std::size_t i = 0;
  for (; v[i] < 6; ++i) {
  }
  const double begin = v[i];
  for (std::size_t k = i; k < 1500; ++k) time += 2 * step[k] / (v[k] + v[k + 1]);
  EXPECT_NEAR(0.5 * (v[1500] * v[1500] - begin * begin), 40 * time, 0.01 * 40 * time);
}

TEST(RacingSpeeds, ACurvatureThatIsNoNumberIsNoStraight) {
  const std::vector<double> curvature{0, std::nan(""), 0}, step(3, 1.0);
  EXPECT_EQ(message_of([&] { racing_speeds(curvature, step, true, {}); }),
            "curvature 1: .nan must be finite");
}

TEST(RacingSpeeds, SteeringTakesTime) {
  // A step of the curvature by 0.5 1/m over 0.1 m: v 0.5 / 0.1 * wheelbase <= rate.
  RacingCar car;
  std::vector<double> curvature(100, 0.0);
  for (std::size_t i = 50; i < 100; ++i) curvature[i] = 0.5;
  const auto v = racing_speeds(curvature, std::vector<double>(100, 0.1), false, car);
  EXPECT_NEAR(v[49], car.max_steering_rate * 0.1 / (0.5 * car.wheelbase), 1e-9);
}

TEST(RacingCar, IsKnownByName) {
  for (const std::string& name : racing_car_names()) {
    EXPECT_EQ(racing_car(name).name, name);
    EXPECT_NO_THROW(validate(racing_car(name)));
  }
  EXPECT_THROW(racing_car("tank"), std::invalid_argument);
  RacingCar car;
  set_friction(car, 0.5);
  EXPECT_DOUBLE_EQ(car.limits.braking, 4.905);
  for (const double friction : {0.0, 1e300, std::nan("")})
    EXPECT_THROW(set_friction(car, friction), std::invalid_argument);
  car.wheelbase = 1e-9;
  EXPECT_EQ(message_of([&] { validate(car); }), "wheelbase: 1e-09 must be within 0.01 to 100");
}

TEST(RacingCar, OfAConfigurationHasItsSizesAndTheGripOfItsPlans) {
  Configuration configuration;
  const RacingCar same = racing_car(configuration), known;
  EXPECT_EQ(same.width, known.width);
  EXPECT_EQ(same.wheelbase, known.wheelbase);
  EXPECT_EQ(same.max_steering_rate, known.max_steering_rate);
  EXPECT_EQ(same.limits.top_speed, known.limits.top_speed);
  auto& tyres = configuration.vehicle.own_of<SingleTrackOptions>();
  tyres.friction = 0.5;
  tyres.usable_grip = 0.8;
  configuration.vehicle.front_length = 1.2;
  configuration.vehicle.rear_length = 1.5;
  configuration.vehicle.body.margin = 0.3;
  configuration.vehicle.max_acceleration = 2;
  configuration.vehicle.max_deceleration = 9;
  configuration.planner.steer_limit = 0.5;
  configuration.planner.max_speed = 1;
  const RacingCar large = racing_car(configuration);
  EXPECT_NO_THROW(validate(large));
  EXPECT_DOUBLE_EQ(large.wheelbase, 2.7);
  EXPECT_EQ(large.max_steering, 0.5);
  EXPECT_DOUBLE_EQ(large.margin, 0.9);
  EXPECT_DOUBLE_EQ(large.limits.lateral_acceleration, 0.4 * 9.81);
  EXPECT_EQ(large.limits.acceleration, 2);
  EXPECT_DOUBLE_EQ(large.limits.braking, 0.4 * 9.81);
  EXPECT_EQ(large.limits.top_speed, racing_car("passenger").limits.top_speed) << "max_speed is for driving";
}

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

}  // namespace slalom::vehicle::racing_car_test
