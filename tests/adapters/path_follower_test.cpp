// A controller of nav2 without ROS: costs of cells, plans, limits and refusals.
#include "logic/path_follower.hpp"

#include <gtest/gtest.h>

namespace slalom::nodes::path_follower_test {
namespace {

using Problem = FollowerAnswer::Problem;

constexpr double period = 0.05;  // s
constexpr unsigned char lethal = 254, inscribed = 253, unknown = 255;

/// A costmap of 8 x 4 m with cells of 0.05 m whose lower left corner lies at the origin.
struct Room {
  static constexpr std::size_t width = 160, height = 80;
  /// The middle of a cell.
  static maps::Point middle(std::size_t cell) {
    return {0.05 * (cell % width + 0.5), 0.05 * (cell / width + 0.5)};
  }
  void fill(double x0, double y0, double x1, double y1, unsigned char cost = lethal) {
    for (std::size_t i = 0; i < costs.size(); ++i)
      if (const maps::Point p = middle(i); p.x >= x0 && p.x <= x1 && p.y >= y0 && p.y <= y1) costs[i] = cost;
  }
  /// Whether an obstacle is nearer than a distance (m).
  bool is_obstacle_within(const maps::Pose& pose, double distance) const {
    for (std::size_t i = 0; i < costs.size(); ++i)
      if (costs[i] == lethal && maps::distance(middle(i), {pose.x, pose.y}) < distance) return true;
    return false;
  }
  CostGrid grid() const { return {width, height, 0.05, 0, 0, costs.data()}; }

  std::vector<unsigned char> costs = std::vector<unsigned char>(width * height);
};

std::vector<maps::Pose> line(double x0, double y0, double x1, double y1) {
  std::vector<maps::Pose> plan;
  const double yaw = std::atan2(y1 - y0, x1 - x0);
  for (int i = 0; i <= 100; ++i) plan.push_back({x0 + i * (x1 - x0) / 100, y0 + i * (y1 - y0) / 100, yaw});
  return plan;
}

/// A robot of 0.4 x 0.4 m in a room of 8 x 4 m that moves as it is told.
struct Drive {
  Drive() {
    follower.change({{"batch_size", "256"}, {"svg_mppi.guide_iterations", "2"}});
    follower.use_footprint({{0.2, 0.2}, {-0.2, 0.2}, {-0.2, -0.2}, {0.2, -0.2}});
  }
  FollowerAnswer step() {
    follower.use_costmap(room.grid());
    input.time += period;
    const FollowerAnswer answer = follower.update(input);
    const navigation::Velocity& v = answer.command;
    maps::Pose& pose = input.pose;
    const double c = std::cos(pose.yaw), sine = std::sin(pose.yaw);
    pose = {pose.x + period * (c * v.forward - sine * v.left),
            pose.y + period * (sine * v.forward + c * v.left), pose.yaw + period * v.turn};
    input.velocity = v;
    fastest = std::max(fastest, v.forward);
    collided = collided || room.is_obstacle_within(pose, 0.2);
    return answer;
  }
  /// Drives until there is a problem, the robot is so near to a point, or for so long (s).
  FollowerAnswer drive(double duration, const maps::Pose& to, double near = 0.15) {
    FollowerAnswer answer;
    const double end = input.time + duration;
    while (input.time < end && answer.problem == Problem::none &&
           std::hypot(input.pose.x - to.x, input.pose.y - to.y) > near)
      answer = step();
    return answer;
  }
  /// The place of the path that is farthest from the line y = 2 m, m to its left.
  double aside() const {
    double farthest = 0;
    for (const maps::Pose& pose : follower.path())
      if (std::abs(pose.y - 2) > std::abs(farthest)) farthest = pose.y - 2;
    return farthest;
  }
  double distance_to(double x, double y) const { return std::hypot(input.pose.x - x, input.pose.y - y); }

  Room room;
  PathFollower follower;
  FollowerInput input{{1, 2, 0}, {}, 100, {}, {}};
  double fastest = 0;
  bool collided = false;
};

/// The same with a straight plan.
struct StraightDrive : Drive {
  StraightDrive() { follower.use_plan(line(1, 2, 7, 2)); }
};

TEST(PathFollower, DrivesRoundAnObstacleAlongAPlanOfAnotherFrame) {
  Drive drive;
  drive.room.fill(3.5, 1.6, 4.2, 2.6);
  // A frame that is turned by a quarter: its x axis points along y of the costmap.
  drive.input.plan_frame = {0, 0, std::acos(0.0)};
  drive.follower.use_plan(line(2, -1, 2, -7));
  const FollowerAnswer answer = drive.drive(40, {7, 2, 0});
  EXPECT_EQ(answer.problem, Problem::none) << answer.why;
  EXPECT_LT(drive.distance_to(7, 2), 0.16) << answer.status;
  EXPECT_FALSE(drive.collided);
  EXPECT_GT(drive.fastest, 0.4);
}

TEST(PathFollower, RefusesABlockedPathWithinHalfASecondAndGoesOnWhenItOpens) {
  StraightDrive drive;
  drive.drive(2, {7, 2, 0});
  drive.room.fill(4, 0, 4.2, 4);
  const double begin = drive.input.time;
  const FollowerAnswer blocked = drive.drive(2, {7, 2, 0});
  EXPECT_EQ(blocked.problem, Problem::no_control);
  EXPECT_EQ(blocked.status, "blocked");
  EXPECT_NE(blocked.why.find("no way round"), std::string::npos) << blocked.why;
  EXPECT_LE(drive.input.time - begin, 0.5 + 1e-9);
  EXPECT_EQ(blocked.command.forward, 0);
  drive.room.fill(4, 0, 4.2, 4, 0);
  drive.drive(1.5, {7, 2, 0});
  EXPECT_EQ(drive.drive(20, {7, 2, 0}).problem, Problem::none);
  EXPECT_LT(drive.distance_to(7, 2), 0.16);
}

TEST(PathFollower, TakesInflatedCostsForFreeAndUnknownCellsAsItIsTold) {
  StraightDrive drive;
  std::fill(drive.room.costs.begin(), drive.room.costs.end(), inscribed);
  EXPECT_EQ(drive.drive(1, {7, 2, 0}).problem, Problem::none) << "253 is no obstacle: the footprint decides";
  EXPECT_GT(drive.fastest, 0.2);
  std::fill(drive.room.costs.begin(), drive.room.costs.end(), unknown);
  drive.fastest = 0;
  EXPECT_EQ(drive.drive(1, {7, 2, 0}).problem, Problem::none) << "unknown cells have a price";
  EXPECT_GT(drive.fastest, 0.2);
  drive.follower.change({{"unknown_cells", "obstacle"}});
  EXPECT_EQ(drive.drive(1, {7, 2, 0}).problem, Problem::no_control);
}

TEST(PathFollower, ADetourAvoidsAZoneOfHighCosts) {
  const auto aside = [](const char* price) {
    StraightDrive drive;
    drive.follower.change({{"cell_price", price}});
    drive.room.fill(3.5, 1.4, 4.2, 2.7);
    drive.room.fill(3, 0, 5, 1.35, 200);  // the shorter way round
    drive.step();
    return drive.aside();
  };
  EXPECT_LT(aside("0"), -0.7) << "the test would not show anything";
  EXPECT_GT(aside("2"), 0.7);
}

TEST(PathFollower, KeepsToSpeedLimitsInPercentAndInMetresPerSecond) {
  StraightDrive drive;
  const auto fastest_in = [&](double duration) {
    drive.drive(1, {7, 2, 0});  // for the change of speed
    drive.fastest = 0;
    drive.drive(duration, {7, 2, 0});
    return drive.fastest;
  };
  drive.follower.limit_speed(40, true);
  EXPECT_NEAR(fastest_in(1), 0.2, 0.03);
  drive.follower.limit_speed(0.3, false);
  EXPECT_NEAR(fastest_in(1), 0.3, 0.03);
  drive.follower.change({{"vx_max", "1"}});
  EXPECT_NEAR(fastest_in(1), 0.3, 0.03) << "an absolute limit does not depend on vx_max";
  drive.follower.reset();
  drive.follower.use_plan(line(1, 2, 7, 2));
  EXPECT_NEAR(fastest_in(1), 0.3, 0.03) << "it outlasts a task";
  EXPECT_THROW(drive.follower.limit_speed(-1, false), std::invalid_argument);
  EXPECT_THROW(drive.follower.limit_speed(std::numeric_limits<double>::quiet_NaN(), true),
               std::invalid_argument);
  EXPECT_NEAR(fastest_in(0.5), 0.3, 0.03);
  drive.follower.limit_speed(0, false);
  EXPECT_GT(fastest_in(0.5), 0.5) << "0 is no limit";
}

TEST(PathFollower, StandsOnlyWhereTheGoalCheckerIsContent) {
  const auto status_at = [](const maps::Pose& pose, const std::optional<GoalTolerance>& tolerance) {
    Drive drive;
    drive.input.pose = pose;
    drive.input.tolerance = tolerance;
    drive.follower.use_plan(line(1, 2, 3, 2));
    return drive.step().status;
  };
  EXPECT_EQ(status_at({2.92, 2, 0}, {}), "goal_reached") << "goal_distance is 0.1 m";
  EXPECT_EQ(status_at({2.92, 2, 0}, GoalTolerance{0.25, 0.25}), "goal_reached");
  EXPECT_EQ(status_at({2.92, 2, 0}, GoalTolerance{0.05, 0.25}), "following");
  EXPECT_EQ(status_at({2.8, 2, 0}, GoalTolerance{0.25, 0.25}), "following") << "it aims for the goal itself";
  EXPECT_EQ(status_at({2.95, 2, 1}, GoalTolerance{0.25, 0.25}), "following");
  EXPECT_EQ(status_at({2.95, 2, 1}, GoalTolerance{0.25, 0}), "goal_reached") << "the heading does not matter";
}

TEST(PathFollower, RefusesWithoutAPlan) {
  Drive drive;
  EXPECT_EQ(drive.step().problem, Problem::invalid_path);
  EXPECT_THROW(drive.follower.use_plan({}), std::invalid_argument);
  EXPECT_EQ(drive.step().problem, Problem::invalid_path);
  drive.follower.use_plan(line(1, 2, 7, 2));
  EXPECT_EQ(drive.step().problem, Problem::none);
  EXPECT_FALSE(drive.follower.predicted().empty());
  EXPECT_FALSE(drive.follower.path().empty());
  drive.follower.reset();
  EXPECT_EQ(drive.step().problem, Problem::invalid_path);
}

TEST(PathFollower, RefusesAPoseThatIsNotFiniteOrOffTheCostmap) {
  StraightDrive drive;
  const maps::Pose pose = drive.input.pose;
  drive.input.pose.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(drive.step().problem, Problem::no_control);
  drive.input.pose = {-3, 2, 0};
  const FollowerAnswer off = drive.step();
  EXPECT_EQ(off.problem, Problem::no_control);
  EXPECT_NE(off.why.find("off the costmap"), std::string::npos) << off.why;
  drive.input.pose = pose;
  EXPECT_EQ(drive.step().problem, Problem::none);
}

TEST(PathFollower, TellsTheCostOfItsPlanByTermsAndItsSamples) {
  StraightDrive drive;
  EXPECT_TRUE(drive.follower.cost_terms().empty() && drive.follower.samples(32).empty());
  drive.drive(2, {7, 2, 0});
  const std::vector<maps::Point> lines = drive.follower.samples(32);
  ASSERT_EQ(lines.size(), 2 * 32 * (drive.follower.predicted().size() - 1));
  for (std::size_t i = 1; i < lines.size(); ++i) EXPECT_LT(maps::distance(lines[i - 1], lines[i]), 1.5);
  EXPECT_EQ(lines[0].x, drive.follower.predicted()[0].x);
  EXPECT_GT(drive.follower.cost_terms().front().value, 1) << "progress";
  EXPECT_STREQ(drive.follower.cost_terms()[3].name, "clearance");
  EXPECT_LT(drive.follower.cost_terms()[3].value, 1e-6);
  drive.room.fill(3, 2.3, 7, 4);
  drive.step();
  EXPECT_GT(drive.follower.cost_terms()[3].value, 0.1);
}

TEST(PathFollower, KeepsToOneSideOfItsPathByACostOfOnesOwn) {
  StraightDrive drive;
  drive.follower.add_cost("keep_left", [](const navigation::RolloutStates& states, std::span<double> costs) {
    for (std::size_t i = 0; i < costs.size(); ++i) costs[i] += 5 * std::max(2.3 - states.y[i], 0.0);
  });
  EXPECT_EQ(drive.drive(30, {7, 2, 0}, 1).problem, Problem::none);
  EXPECT_NEAR(drive.input.pose.y, 2.3, 0.1);
  EXPECT_STREQ(drive.follower.cost_terms().back().name, "keep_left");
  EXPECT_GT(drive.follower.cost_terms().back().value, 0.05);
}

TEST(PathFollower, BrakesWhenItIsCancelled) {
  StraightDrive drive;
  drive.drive(2, {7, 2, 0});
  ASSERT_GT(drive.input.velocity.forward, 0.3);
  int periods = 0;
  for (double before = drive.input.velocity.forward; !drive.follower.cancel() && periods < 20; ++periods) {
    EXPECT_EQ(drive.step().problem, Problem::none);
    EXPECT_LE(drive.input.velocity.forward, before);
    EXPECT_GE(drive.input.velocity.forward, before - 2.5 * period - 1e-6);
    before = drive.input.velocity.forward;
  }
  EXPECT_GE(periods, 2) << "it does not stop at once";
  EXPECT_LT(periods, 10);
  EXPECT_LT(drive.input.velocity.forward, 0.01);
  drive.follower.use_plan(line(1, 2, 7, 2));
  drive.drive(1, {7, 2, 0});
  EXPECT_GT(drive.input.velocity.forward, 0.1) << "a new plan ends the cancellation";
}

TEST(PathFollower, KeepsItsDetourWhenThePlannerPlansTheSameWayAgain) {
  StraightDrive drive;
  drive.room.fill(3.5, 1.6, 4.2, 2.6);
  ASSERT_EQ(drive.step().status, "detour");
  EXPECT_GT(std::abs(drive.aside()), 0.3);
  const double begin = drive.follower.path().front().x;
  drive.drive(1.5, {7, 2, 0});
  drive.follower.use_plan(line(drive.input.pose.x, 2, 7, 2));
  EXPECT_EQ(drive.step().status, "detour");
  EXPECT_EQ(drive.follower.path().front().x, begin) << "the same detour, not a new one from where it is";
  drive.follower.use_plan(line(drive.input.pose.x, 2, 7, 2.5));
  drive.step();
  EXPECT_GT(drive.follower.path().front().x, begin + 0.2) << "another goal is news";
}

/// A sensor sees each end of an obstacle now here and now there, by 0.2 m, so that either way round may be
/// the shorter one.
TEST(PathFollower, PassesAnObstacleWhoseEndsFlickerOnOneSide) {
  const auto changes_of_side = [](std::uint64_t seed, bool forgets) {
    StraightDrive drive;
    drive.follower.change({{"svg_mppi.seed", std::to_string(seed)}});
    RandomStream random({seed, 0});
    int changes = 0;
    for (double side = 0; drive.distance_to(7, 2) > 0.15 && drive.input.time < (forgets ? 102 : 113);) {
      std::fill(drive.room.costs.begin(), drive.room.costs.end(), 0);
      drive.room.fill(3.5, 1.5 + 0.2 * random.uniform(), 4.2, 2.3 + 0.2 * random.uniform());
      if (forgets) drive.follower.reset();
      if (forgets) drive.follower.use_plan(line(drive.input.pose.x, 2, 7, 2));
      drive.step();
      if (std::abs(drive.aside()) > 0.2) changes += drive.aside() * std::exchange(side, drive.aside()) < 0;
    }
    EXPECT_EQ(drive.distance_to(7, 2) < 0.15, !forgets);
    EXPECT_FALSE(drive.collided);
    return changes;
  };
  for (std::uint64_t seed = 1; seed <= 10; ++seed) EXPECT_EQ(changes_of_side(seed, false), 0) << seed;
  EXPECT_GT(changes_of_side(1, true), 10) << "the test would not show anything";
}

TEST(PathFollower, MovesItsPathWithTheFrameOfThePlanAndKeepsItsPlaceOnIt) {
  StraightDrive drive;
  drive.drive(4, {7, 2, 0});
  const double x = drive.input.pose.x;
  const auto path_in = [&](const maps::Pose& frame) {
    drive.input.plan_frame = frame;
    drive.step();
    return drive.follower.path();
  };
  EXPECT_NEAR(path_in({0, 0.01, 0}).back().y, 2, 1e-9);
  EXPECT_NEAR(path_in({0, 0.03, 0}).back().y, 2.03, 1e-9);
  EXPECT_GT(path_in({0, 0.06, 0}).front().x, x - 0.6);
  EXPECT_THROW(drive.follower.use_plan({{0, 0, 0}, {std::nan(""), 0, 0}}), std::invalid_argument);
  EXPECT_NEAR(path_in({0, 0.09, 0}).back().y, 2.09, 1e-9) << "the present plan stays";
}

TEST(PathFollower, PlansFromItsLastCommandInOpenLoop) {
  const auto speed_after = [](const char* open_loop, int periods) {
    StraightDrive drive;
    drive.follower.change({{"open_loop", open_loop}});
    double speed = 0;
    for (int i = 0; i < periods; ++i) {
      drive.input.velocity = {};  // as if the odometry came much later
      speed = drive.step().command.forward;
    }
    return speed;
  };
  EXPECT_LE(speed_after("false", 10), 2.5 * period + 1e-6);
  EXPECT_GT(speed_after("true", 10), 0.3);
}

TEST(PathFollower, RefusesFootprintsAndCostmapsThatAreNone) {
  Drive drive;
  EXPECT_THROW(drive.follower.use_footprint({}), std::invalid_argument);
  EXPECT_THROW(drive.follower.use_footprint({{0.1, 0}, {0.2, 0}, {0.1, 0.1}}), std::invalid_argument)
      << "the robot's origin lies outside";
  const unsigned char cells[4] = {};
  EXPECT_THROW(drive.follower.use_costmap({2, 2, 0.05, 0, 0, cells}), std::invalid_argument);
  drive.follower.use_plan(line(1, 2, 7, 2));
  EXPECT_EQ(drive.step().problem, Problem::none);
  // It fits through a door of 1 m. A body of 1.4 m does not.
  drive.room.fill(4, 0, 4.2, 1.5);
  drive.room.fill(4, 2.5, 4.2, 4);
  EXPECT_EQ(drive.drive(0.5, {7, 2, 0}).status, "following");
  drive.follower.use_footprint({{0.7, 0.7}, {-0.7, 0.7}, {-0.7, -0.7}, {0.7, -0.7}});
  EXPECT_EQ(drive.drive(1, {7, 2, 0}).problem, Problem::no_control);
}

}  // namespace
}  // namespace slalom::nodes::path_follower_test
