// The checks that every driving node makes of its inputs, with clocks that the tests set.
// A robot of nav2 among people who cross its way and do not look: it has its costmap and its scans alone.
#include <gtest/gtest.h>

#include "logic/input_watch.hpp"
#include "logic/localiser_core.hpp"
#include "logic/path_follower.hpp"
#include "logic/reports.hpp"
#include "slalom/sim/room/room.hpp"

namespace slalom::nodes::input_watch_test {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

class InputWatchTest : public ::testing::Test {
 protected:
  /// Lets time pass, s.
  void pass(double seconds) {
    now_ += seconds;
    steady_ += seconds;
  }

  double now_ = 5000, steady_ = 300;  ///< s
  InputWatch watch_{{}, {[this] { return now_; }, [this] { return steady_; }}};
};

TEST_F(InputWatchTest, AcceptsAMessageOfNow) {
  EXPECT_TRUE(watch_.accepts("scan", now_, 0));
  EXPECT_TRUE(watch_.accepts("scan", now_ - 0.14, now_ - 0.14)) << "as old as it may be, and sent twice";
  EXPECT_TRUE(watch_.accepts("scan", now_ + 0.04, now_)) << "from a clock that is slightly ahead";
  EXPECT_EQ(watch_.fault(), "");
}

TEST_F(InputWatchTest, RejectsStampsThatAreLateOutOfOrderOrFromTheFuture) {
  EXPECT_FALSE(watch_.accepts("scan", now_ + 5, now_));
  EXPECT_EQ(watch_.fault(), "scan from the future, by 5.00 s");
  EXPECT_FALSE(watch_.accepts("scan", now_ - 0.05, now_));
  EXPECT_EQ(watch_.fault(), "scan out of order");
  EXPECT_FALSE(watch_.accepts("odometry", now_ - 0.5, 0));
  EXPECT_EQ(watch_.fault(), "odometry late by 0.50 s");
  EXPECT_FALSE(watch_.accepts("odometry", unknown, 0));
}

TEST_F(InputWatchTest, AFaultLastsUntilItHasSettled) {
  watch_.report("fault");
  pass(0.24);
  EXPECT_EQ(watch_.fault(), "fault");
  pass(0.02);
  EXPECT_EQ(watch_.fault(), "");
}

TEST_F(InputWatchTest, AConsequenceExtendsAFaultAndKeepsItsReason) {
  watch_.report("cause");
  pass(0.2);
  watch_.report_consequence("consequence");
  pass(0.2);
  EXPECT_EQ(watch_.fault(), "cause");
  pass(1);
  watch_.report_consequence("consequence");
  EXPECT_EQ(watch_.fault(), "consequence") << "the cause was long ago";
}

TEST_F(InputWatchTest, AnInputThatIsMissingOrOldIsAFault) {
  EXPECT_FALSE(watch_.fresh("scan", 0));
  EXPECT_EQ(watch_.fault(), "no scan yet");
  EXPECT_TRUE(watch_.fresh("scan", now_ - 0.1));
  pass(2);
  EXPECT_EQ(watch_.fault(), "");
  EXPECT_FALSE(watch_.fresh("odometry", now_ - 0.3));
  EXPECT_EQ(watch_.fault(), "no odometry for 0.30 s");
}

TEST_F(InputWatchTest, AClockThatJumpsIsAFault) {
  EXPECT_TRUE(watch_.clock_runs());
  pass(10);
  EXPECT_TRUE(watch_.clock_runs()) << "both clocks went on";
  now_ += 20;
  EXPECT_FALSE(watch_.clock_runs());
  EXPECT_EQ(watch_.fault(), "the clock jumped by 20.00 s");
  EXPECT_TRUE(watch_.clock_runs());
  now_ -= 20;
  EXPECT_FALSE(watch_.clock_runs());
  EXPECT_EQ(watch_.fault(), "the clock jumped by -20.00 s");
  now_ += 0.3;
  EXPECT_TRUE(watch_.clock_runs()) << "a correction of the clock";
}

TEST_F(InputWatchTest, APoseThatTheCarCannotHaveReachedIsAFault) {
  EXPECT_TRUE(watch_.moves_like_a_car({1, 2, 3.1}, now_));
  EXPECT_TRUE(watch_.moves_like_a_car({1.2, 2, -3.1}, now_ + 0.025)) << "a small turn across half a turn";
  EXPECT_FALSE(watch_.moves_like_a_car({4.2, 2, -3.1}, now_ + 0.05));
  EXPECT_EQ(watch_.fault(), "pose jumped by 3 m");
  EXPECT_TRUE(watch_.moves_like_a_car({4.2, 2, -3.1}, now_ + 0.075)) << "where it jumped to";
  EXPECT_FALSE(watch_.moves_like_a_car({4.2, 2, 0}, now_ + 0.1)) << "a turn within one period";
  EXPECT_FALSE(watch_.moves_like_a_car({1e300, 2, 0}, now_ + 0.125));
  EXPECT_EQ(watch_.fault(), "pose jumped by 1e+300 m");
  watch_.forget();
  EXPECT_TRUE(watch_.moves_like_a_car({4.2, 2, 0}, now_ + 0.15));
}

TEST_F(InputWatchTest, APoseThatIsNotFiniteIsAFaultAndIsNotComparedWith) {
  EXPECT_TRUE(watch_.moves_like_a_car({1, 2, 3}, now_));
  for (const maps::Pose& pose :
       {maps::Pose{unknown, 2, 3}, maps::Pose{1, unknown, 3}, maps::Pose{1, 2, unknown}}) {
    EXPECT_FALSE(watch_.moves_like_a_car(pose, now_ + 0.01));
    EXPECT_EQ(watch_.fault(), "pose is not finite");
  }
  EXPECT_TRUE(watch_.moves_like_a_car({1, 2, 3}, now_ + 0.02));
}

TEST(CountFits, ComparesTheNumberOfRangesWithTheAngles) {
  const auto scan = [](std::size_t count, double increment) {
    static const std::vector<float> ranges(500);
    return maps::LaserScanView{{ranges.data(), count}, -2, increment, 0, 10};
  };
  EXPECT_TRUE(count_fits(scan(401, 0.01), 2));
  EXPECT_TRUE(count_fits(scan(400, 0.01), 2)) << "drivers differ in whether they count the last beam";
  EXPECT_FALSE(count_fits(scan(200, 0.01), 2));
  EXPECT_FALSE(count_fits(scan(401, 0), 2));
  EXPECT_FALSE(count_fits(scan(401, unknown), 2));
  EXPECT_FALSE(count_fits(scan(401, 0.01), unknown));
}

vehicle::LocaliserOutput estimate(bool usable, double health) {
  return {.status = usable ? vehicle::LocaliserStatus::ok : vehicle::LocaliserStatus::odometry_jump,
          .pose = {},
          .health = health};
}

TEST(PoseTrust, ComesBackAfterConsecutiveGoodScans) {
  PoseTrust trust(3, 0.7);
  EXPECT_EQ(trust.doubt(), "uncertain");
  EXPECT_FALSE(trust.update(estimate(true, 0.8)));
  EXPECT_FALSE(trust.update(estimate(true, 0.8)));
  EXPECT_FALSE(trust.update(estimate(false, 0.8)));
  EXPECT_EQ(trust.doubt(), "odometry_jump");
  for (int scan = 1; scan <= 3; ++scan) {
    EXPECT_EQ(trust.update(estimate(true, 0.8)), scan == 3) << scan;
    EXPECT_EQ(trust.doubt(), "odometry_jump, over, until it is sure");
  }
  EXPECT_TRUE(trust.update(estimate(true, 0.1))) << "trust lasts while the estimate is usable";
  EXPECT_FALSE(trust.update(estimate(false, 0.9)));
  EXPECT_FALSE(trust.holds());
  for (int scan = 1; scan <= 18; ++scan)
    EXPECT_EQ(trust.update(estimate(true, 0.6)), scan == 18) << "mediocre, scan " << scan;
}

TEST(RecentValues, AreTheLatest) {
  RecentValues recent;
  EXPECT_TRUE(recent.values().empty());
  for (int i = 0; i < 410; ++i) recent.add(i);
  EXPECT_EQ(recent.values().size(), 400U);
  EXPECT_EQ(*std::min_element(recent.values().begin(), recent.values().end()), 10);
}

TEST(ThrottledLog, WritesAtMostOneMessagePerSecondAndTheLastOneThatWaits) {
  double steady = 7;
  std::vector<std::string> written;
  ThrottledLog log([&] { return steady; }, [&](const std::string& message) { written.push_back(message); });
  log("first");
  steady += 0.4;
  log("second");
  log("third");
  EXPECT_EQ(written, std::vector<std::string>{"first"});
  steady += 0.7;
  log.flush();
  log.flush();
  EXPECT_EQ(written, (std::vector<std::string>{"first", "third"}));
}

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
        const std::size_t row = i / 240, column = i % 240;
        const maps::Point before = each.at(input.time - late),
                          cell{0.05 * (column + 0.5), 0.05 * (row + 0.5)};
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

TEST(PathFollowerPeople, AreNotTouchedIn27CrossingsThatItsTrackerOrItsNavigatorSees) {
  int with_tracker = 0, with_costmap_alone = 0;
  for (const char* seed : {"1", "2", "3"})
    for (double shift = -2; shift <= 2; shift += 0.5) {
      with_tracker += touched("scan", shift, seed);
      if (seed[0] == '1') with_costmap_alone += touched("none", shift, seed);
    }
  EXPECT_EQ(with_tracker, 0);
  EXPECT_EQ(with_costmap_alone, 0);
}

}  // namespace

}  // namespace slalom::nodes::input_watch_test
