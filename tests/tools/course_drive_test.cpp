// Every course of ours can be driven at its own profile: a plain path follower laps it and keeps clear of the
// walls.
#include <gtest/gtest.h>

#include <filesystem>

#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/course/course.hpp"

namespace slalom::tools {
namespace {

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
