// A robot of nav2 among people who cross its way and do not look: it has its costmap and its scans alone.
#include <gtest/gtest.h>

#include "logic/path_follower.hpp"
#include "slalom/sim/room/room.hpp"

namespace slalom::nodes::people_test {
namespace {

constexpr double period = 0.05, radius = 0.25, late = 0.2;  // s; m, of a person; s, of the costmap

/// Somebody who walks straight at a speed (m/s) from a time (s) on.
struct Walker {
  double begin, speed;
  maps::Point from, to;
  maps::Point at(double time) const {
    const double way = std::hypot(to.x - from.x, to.y - from.y);
    const double share = std::clamp((time - begin) * speed / way, 0.0, 1.0);
    return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
  }
};

/// Drives through a room of 12 x 8 m that two people cross, and says how often the robot touched one while it
/// moved. `shift`: s by which they set out later.
int touched(const char* others, double shift, const char* seed) {
  const Walker walkers[] = {{6 + shift, 1.2, {5.5, 0.6}, {5.5, 7.6}},
                            {10 + shift, 1, {7.5, 7.6}, {7.5, 0.5}}};
  PathFollower follower;
  follower.change({{"others", others}, {"batch_size", "256"}, {"svg_mppi.seed", seed}});
  follower.use_footprint({{0.35, 0.25}, {-0.35, 0.25}, {-0.35, -0.25}, {0.35, -0.25}});
  std::vector<maps::Pose> plan;
  for (int i = 0; i <= 100; ++i) plan.push_back({1 + 0.1 * i, 4, 0});
  follower.use_plan(plan);
  sim::Room room;
  room.length = 12, room.width = 8;
  std::vector<double> seen(720);
  std::vector<float> ranges(seen.size());
  FollowerInput input{{1, 4, 0}, {}, 0, {}, {}};
  int count = 0;
  bool touching = false;
  for (; input.time < 60 && input.pose.x < 10.8; input.time += period) {
    room.people.clear();
    std::vector<unsigned char> costs(240 * 160);
    for (const Walker& each : walkers) {
      room.people.push_back({each.at(input.time), radius});
      for (std::size_t i = 0; i < costs.size(); ++i) {
        const maps::Point before = each.at(input.time - late),
                          cell{0.05 * (i % 240 + 0.5), 0.05 * (i / 240 + 0.5)};
        if (maps::distance(cell, before) < radius) costs[i] = 254;
      }
    }
    sim::scan(room, input.pose, 10, seen);
    std::copy(seen.begin(), seen.end(), ranges.begin());
    follower.people().see({.scan = {ranges, 0, 2 * std::numbers::pi / 720, 0.02, 10},
                           .sensor = input.pose,
                           .stamp = input.time});
    follower.use_costmap({240, 160, 0.05, 0, 0, costs.data()});
    const FollowerAnswer answer = follower.update(input);
    const navigation::Velocity& v = input.velocity = answer.command;
    maps::Pose& pose = input.pose;
    pose = {pose.x + period * v.forward * std::cos(pose.yaw),
            pose.y + period * v.forward * std::sin(pose.yaw), pose.yaw + period * v.turn};
    bool touches = false;
    for (const Walker& each : walkers) {
      const maps::Point at = maps::inverse_transform(pose, each.at(input.time + period));
      touches = touches || std::hypot(std::max(std::abs(at.x) - 0.35, 0.0),
                                      std::max(std::abs(at.y) - 0.25, 0.0)) < radius;
    }
    const bool moves = std::abs(v.forward) > 0.03 || std::abs(v.turn) > 0.05;
    count += touches && !touching && moves;
    touching = touches;
  }
  EXPECT_GT(input.pose.x, 10.7) << "shift " << shift << ", seed " << seed << ", at " << input.pose.x;
  return count;
}

TEST(PathFollowerPeople, AreNotTouchedIn27CrossingsThatItsOwnTrackerSees) {
  int with_tracker = 0, with_costmap_alone = 0;
  for (const char* seed : {"1", "2", "3"})
    for (double shift = -2; shift <= 2; shift += 0.5) {
      with_tracker += touched("scan", shift, seed);
      if (seed[0] == '1') with_costmap_alone += touched("none", shift, seed);
    }
  EXPECT_EQ(with_tracker, 0);
  EXPECT_GT(with_costmap_alone, 0) << "the test would not show anything";
}

}  // namespace
}  // namespace slalom::nodes::people_test
