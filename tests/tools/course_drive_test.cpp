// Every course of ours can be driven at its own profile: a plain path follower in the single-track plant laps
// it and keeps clear of the walls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "slalom/maps/distance_field.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/vehicle/course/course.hpp"

namespace slalom::tools {
namespace {

constexpr double time_step = 0.005, control_period = 0.025;  // s
constexpr double half_body_width = 0.155;                    // m

struct Lap {
  bool finished = false;
  double time = 0;             ///< s
  double min_clearance = 1e9;  ///< m, from the car's middle to a wall
  double largest_error = 0;    ///< m, from the raceline
};

Lap drive(const vehicle::Course& course) {
  std::vector<sim::PathPoint> path;
  for (const auto& point : course.waypoints) path.push_back({{point.x, point.y}, point.speed});
  const std::size_t rows = path.size();
  sim::PurePursuitOptions follow;
  follow.lookahead = 0.9;
  const sim::PurePursuit pursuit(path, follow);
  sim::Plant plant(sim::CarParameters{}, {}, time_step);
  plant.reset({.x = course.start.x, .y = course.start.y, .yaw = course.start.yaw});
  const auto distance = maps::distance_transform(course.map, true);

  Lap lap;
  std::size_t half_way = 0, row = 0;
  const double limit = 3 * vehicle::profile_time(course);
  for (; lap.time < limit; lap.time += control_period) {
    const auto& state = plant.state();
    const maps::Point at = maps::inverse_transform(course.map.origin, {state.x, state.y});
    const int column = static_cast<int>(std::floor(at.x / course.map.resolution));
    const int line = static_cast<int>(std::floor(at.y / course.map.resolution));
    if (!course.map.contains(column, line)) return lap;
    lap.min_clearance = std::min(lap.min_clearance, distance.at(column, line));
    const auto nearest = pursuit.nearest({state.x, state.y});
    lap.largest_error = std::max(lap.largest_error, nearest.distance);
    row = nearest.segment;
    if (row > 2 * rows / 5 && row < 3 * rows / 5) half_way = row;
    if (half_way && row < rows / 5) {
      lap.finished = true;
      return lap;
    }
    const Command command = pursuit.command({state.x, state.y, state.yaw});
    for (int k = 0; k < static_cast<int>(std::lround(control_period / time_step)); ++k) plant.step(command);
  }
  return lap;
}

TEST(ShippedCourse, CanBeLappedAtItsOwnProfile) {
  for (const auto& name : vehicle::course_names({SLALOM_COURSES})) {
    const vehicle::Course course = vehicle::load_course(std::filesystem::path(SLALOM_COURSES) / name);
    const Lap lap = drive(course);
    EXPECT_TRUE(lap.finished) << name;
    EXPECT_GT(lap.min_clearance, half_body_width + 0.15) << name;
    EXPECT_LT(lap.largest_error, 0.15) << name;
  }
}

}  // namespace
}  // namespace slalom::tools
