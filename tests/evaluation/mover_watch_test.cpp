// MoverWatch knows what moves from scans alone: people are followed and predicted, and pallets are not.
#include "evaluation/rooms/mover_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "slalom/core/random.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"
#include "slalom/sim/room/crowd.hpp"

namespace slalom::evaluation {
namespace {

constexpr int beams = 240;
constexpr double period = 0.05, max_range = 16;  // s, m

/// A scanner in a room of 10 x 6 m with a pallet.
struct Scanner {
  sim::Room room{10, 6, {}, {{{7, 1.5, 0.2}, 1.2, 0.8}}};
  MoverWatch watch{beams};
  RandomStream random{{5, 0}};
  std::vector<double> ranges = std::vector<double>(beams);
  double time = 0;

  std::span<const maps::PredictedObstacle> look(const maps::Pose& from) {
    sim::scan(room, from, max_range, ranges);
    for (double& range : ranges)
      if (range < max_range) range += 0.01 * random.normal();
    time += period;
    return watch.update({from, ranges, max_range}, time);
  }
};

TEST(MoverWatch, PredictsSomebodyWhoWalks) {
  for (const bool ahead : {true, false}) {
    Scanner scanner;
    const sim::Walker walker{{ahead ? maps::Point{6, 3} : maps::Point{4, 5}, {2.8, 3.4}}, 0.8};
    sim::Crowd crowd(scanner.room, {walker});
    int predicted = 0, scans = 0;
    for (int i = 0; i < 50; ++i) {
      for (int k = 0; k < 5; ++k) crowd.step(period / 5, {{1, 1, 0}, 0.7, 0.5}, {});
      const sim::Disc& body = crowd.bodies()[0];
      scanner.room.people = {body};
      const auto others = scanner.look({2, 3, 0});
      const maps::Point& v = crowd.velocities()[0];
      if (i < 16 || std::hypot(v.x, v.y) < 0.5) continue;
      ++scans;
      for (const maps::PredictedObstacle& each : others) {
        const maps::Pose now = each.at(0, 0).pose, then = each.at(0, 1).pose;
        EXPECT_LT(std::hypot(now.x - body.middle.x, now.y - body.middle.y), 0.3) << i;
        if (std::hypot(then.x - body.middle.x - v.x, then.y - body.middle.y - v.y) < 0.5) ++predicted;
      }
      if (others.empty()) continue;
      const navigation::RangeScan left = scanner.watch.without_movers();
      for (std::size_t b = 0; b < left.ranges.size(); ++b) {
        const double angle = 2 * 3.141592653589793 * static_cast<double>(b) / beams;
        const double x = 2 + scanner.ranges[b] * std::cos(angle), y = 3 + scanner.ranges[b] * std::sin(angle);
        if (std::hypot(x - body.middle.x, y - body.middle.y) < 0.25) {
          EXPECT_TRUE(std::isnan(left.ranges[b])) << i;
        } else if (std::hypot(x - body.middle.x, y - body.middle.y) > 0.9) {
          EXPECT_EQ(left.ranges[b], scanner.ranges[b]) << i;
        }
      }
    }
    EXPECT_GE(scans, 20);
    EXPECT_GE(predicted, 0.8 * scans) << ahead;
  }
}

TEST(MoverWatch, PalletsAndWallsDoNotMove) {
  Scanner scanner;
  scanner.room.walls = {{{4, 4, 0}, 0.2, 3}};
  for (int i = 0; i < 200; ++i) {
    const double turn = 0.4 * std::sin(0.05 * i);
    EXPECT_TRUE(scanner.look({1 + 0.025 * i, 2.5 - 0.5 * std::sin(0.02 * i), turn}).empty()) << i;
  }
}

TEST(RoomDrive, WithoutPeopleItIsTheSameWithAndWithoutWatchingForThem) {
  RoomDriver watching, blind;
  SvgMppiOptions options = navigation::svg_mppi_options({});
  options.samples = 512;
  watching.solver = blind.solver = options;
  blind.predict_movers = false;
  const RoomDrive a = drive_room(room_scenario("pallet-on-path"), watching, 2),
                  b = drive_room(room_scenario("pallet-on-path"), blind, 2);
  ASSERT_EQ(a.trace.size(), b.trace.size());
  EXPECT_EQ(a.trace.back().x, b.trace.back().x);
  EXPECT_EQ(a.length, b.length);
}

TEST(RoomDrive, WaitsForOrPassesSomebodyWhoCrosses) {
  const RoomDrive drive = drive_room(room_scenario("crossing-walker"), {}, 101);
  EXPECT_EQ(drive.outcome, RoomOutcome::reached);
  ASSERT_EQ(drive.people.size(), 1u);
  EXPECT_EQ(drive.people[0].size(), drive.trace.size());
  EXPECT_LT(drive.people[0].back().y, 1) << "the walker has crossed";
}

}  // namespace
}  // namespace slalom::evaluation
