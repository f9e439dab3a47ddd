// What the bridge promises to programs that are not compiled as C++20: what it refuses changes nothing.
#include "bridge/bridge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace slalom_bridge {
namespace {

template <class Part>
std::string value_of(const Part& part, const std::string& option) {
  for (const Option& each : part.options())
    if (each.name == option) return each.value;
  return "no such option";
}

std::vector<Waypoint> line() {
  std::vector<Waypoint> path;
  for (int i = 0; i < 40; ++i) path.push_back({0.5 * i, 0, 0, 2});
  return path;
}

Grid room() {
  Grid grid{40, 20, 0.1, {}, std::vector<std::int8_t>(800, 0)};
  for (int i = 0; i < 40; ++i) grid.cells[static_cast<std::size_t>(i)] = 100;
  return grid;
}

TEST(BridgePlanner, AnInvalidOptionChangesNothing) {
  Planner planner("", "mppi");
  planner.change({{"mppi/samples", "64"}, {"planner/max_speed", "3"}});
  EXPECT_THROW(planner.change({{"mppi/samples", "128"}, {"mppi/horizon", "0"}}), std::exception);
  EXPECT_THROW(planner.change({{"mppi/samples", "128"}, {"mppi/none", "1"}}), std::exception);
  EXPECT_EQ(value_of(planner, "mppi/samples"), "64");
  EXPECT_EQ(value_of(planner, "planner/max_speed"), "3");
  EXPECT_THROW(Planner("", "none"), std::exception);
  EXPECT_THROW(Planner("no/such/file.yaml", "mppi"), std::exception);
}

TEST(BridgePlanner, StopsWithoutAPathAndKeepsTheOneItHas) {
  Planner planner("", "mppi");
  planner.change({{"mppi/samples", "64"}});
  const std::vector<float> ranges(271, 10);
  const Scan scan{ranges.data(), ranges.size(), -2.35, 4.7 / 270, 0.05, 30};
  const Command without = planner.update(scan, {1, 0, 0}, 1);
  EXPECT_FALSE(without.ok);
  EXPECT_EQ(without.status, "no path");
  EXPECT_EQ(without.speed, 0);
  EXPECT_TRUE(planner.predicted().empty());

  EXPECT_THROW(planner.use_path({{0, 0, 0, 1}, {1, 0, 0, 1}}), std::exception);
  EXPECT_FALSE(planner.has_path());
  planner.use_path(line());
  std::vector<Waypoint> broken = line();
  broken[7].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(planner.use_path(broken), std::exception);
  EXPECT_TRUE(planner.has_path());
  const Command with = planner.update(scan, {1, 0, 0}, 1);
  EXPECT_TRUE(with.ok) << with.status;
  EXPECT_GT(with.speed, 0);
}

TEST(BridgePlanner, TellsWhyItBrakes) {
  Planner planner("", "mppi");
  planner.change({{"mppi/samples", "64"}});
  planner.use_path(line());
  const std::vector<float> ranges(271, 10), unknown(271, std::numeric_limits<float>::quiet_NaN());
  Scan scan{ranges.data(), ranges.size(), -2.35, 4.7 / 270, 0.05, 30};
  const Command fast = planner.update(scan, {1, 0, 0}, 4132);
  EXPECT_FALSE(fast.ok);
  EXPECT_EQ(fast.status, "bad_odometry");
  EXPECT_EQ(fast.speed, 0);
  scan.ranges = unknown.data();
  const Command blind = planner.update(scan, {1, 0, 0}, 1);
  EXPECT_FALSE(blind.ok);
  EXPECT_EQ(blind.status, "bad_scan");
  EXPECT_EQ(blind.speed, 0);
}

TEST(BridgeLocaliser, AnInvalidMapOrOptionChangesNothing) {
  Localiser localiser;
  EXPECT_EQ(localiser.update({}, {}, 1).status, "no map");
  Grid torn = room();
  torn.cells.pop_back();
  EXPECT_THROW(localiser.use_map(torn), std::exception);
  EXPECT_FALSE(localiser.has_map());
  localiser.use_map(room());
  EXPECT_THROW(localiser.use_map(torn), std::exception);
  Grid flat = room();
  flat.resolution = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(localiser.use_map(flat), std::exception);
  EXPECT_TRUE(localiser.has_map());

  const std::string beams = value_of(localiser, "beams");
  EXPECT_THROW(localiser.change({{"beams", "20"}, {"min_particles", "0"}}), std::exception);
  EXPECT_THROW(localiser.change({{"beams", "20"}, {"none", "1"}}), std::exception);
  EXPECT_EQ(value_of(localiser, "beams"), beams);
}

TEST(BridgeLocaliser, AnInputThatIsNotFiniteIsNotUsable) {
  Localiser localiser;
  localiser.use_map(room());
  localiser.start_at({2, 1, 0});
  const std::vector<float> ranges(271, std::numeric_limits<float>::quiet_NaN());
  const Scan scan{ranges.data(), ranges.size(), -2.35, 4.7 / 270, 0.05, 30};
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (const Pose& odometry : {Pose{0, 0, 0}, Pose{unknown, 0, 0}, Pose{1e9, 0, 0}}) {
    const Estimate seen = localiser.update(scan, odometry, 1);
    EXPECT_FALSE(seen.usable) << seen.status;
    EXPECT_TRUE(std::isfinite(seen.pose.x) && std::isfinite(seen.pose.y) && std::isfinite(seen.pose.yaw));
  }
}

TEST(BridgeLocaliser, AChangeOfOptionsKeepsTheStartThatWasTold) {
  Localiser localiser;
  localiser.use_map(room());
  localiser.start_at({2, 1, 0.5});
  localiser.change({{"beams", "20"}});
  const std::vector<Pose> some = localiser.particles(50);
  ASSERT_FALSE(some.empty());
  for (const Pose& each : some) {
    EXPECT_NEAR(each.x, 2, 1.5);
    EXPECT_NEAR(each.y, 1, 1.5);
    EXPECT_NEAR(each.yaw, 0.5, 1);
  }
}

TEST(BridgeImu, ReadingsThatNoCarHasAreIgnored) {
  ImuSamples samples;
  samples.add(0.5, 1, -1);
  samples.add(std::numeric_limits<double>::quiet_NaN(), 1, 1);
  samples.add(0.5, 1e9, 1);
  samples.add(0.7, 3, -3);
  EXPECT_EQ(samples.count(), 2);
  EXPECT_DOUBLE_EQ(samples.yaw_rate(), 0.6);
  EXPECT_DOUBLE_EQ(samples.forward(), 2);
  EXPECT_DOUBLE_EQ(samples.leftward(), -2);
}

}  // namespace
}  // namespace slalom_bridge
