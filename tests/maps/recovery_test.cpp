// The states of a vehicle that does not get on, and for how long it stands in each.
#include "slalom/maps/recovery.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slalom::maps::recovery_test {
namespace {

constexpr double period = 0.025, length = 100;
const RecoveryLengths small_car = RecoveryLengths::of(0.58);

/// Advances a car on a closed course. Returns whether it reverses.
bool reverses(Recovery& recovery, double arc, double speed, double free_speed = 2, bool waits = false) {
  recovery.update({arc, speed, free_speed, length, waits}, period);
  return recovery.reverses();
}

/// Lets a car stand at an arc length (m) until it reverses. Returns for how long, s.
double waiting_time(Recovery& recovery, double arc, double free_speed = 2) {
  int waited = 0;
  while (!reverses(recovery, arc, 0, free_speed)) ++waited;
  return waited * period;
}

/// Lets a car reverse from an arc length (m) at 1 m/s. Returns how far, m.
double reversed_way(Recovery& recovery, double arc, double free_speed = 2) {
  double way = 0;
  while (reverses(recovery, arc - way, -1, free_speed)) way += period;
  return way;
}

TEST(Recovery, LeavesACarThatGetsOnAlone) {
  Recovery recovery(small_car);
  for (int k = 0; k < 4000; ++k)
    EXPECT_FALSE(reverses(recovery, std::fmod(0.05 * k, length), 2)) << "step " << k;
  EXPECT_EQ(recovery.state(), DriveState::following);
}

TEST(Recovery, ReversesACarThatStandsAndDrivesOnAfterTheWayItChose) {
  Recovery recovery(small_car);
  EXPECT_NEAR(waiting_time(recovery, 7), 0.7, 0.05);
  EXPECT_NEAR(reversed_way(recovery, 7), 0.8, 0.05);
  EXPECT_EQ(recovery.state(), DriveState::retrying);
  EXPECT_EQ(recovery.margin_share(), 1);
}

TEST(Recovery, LengthsGrowWithTheBodyAndSpeedsWithItsRoot) {
  const RecoveryLengths large = RecoveryLengths::of(4 * 0.58);
  EXPECT_NEAR(large.reverse / small_car.reverse, 2, 1e-12);
  EXPECT_NEAR(large.standing / small_car.standing, 2, 1e-12);
  Recovery recovery(large);
  EXPECT_NEAR(waiting_time(recovery, 7), 0.7, 0.05);
  EXPECT_NEAR(reversed_way(recovery, 7), 3.2, 0.05);
}

TEST(Recovery, ACarThatWaitsForOneThatDrivesIsNotStuck) {
  Recovery recovery(small_car);
  for (int k = 0; k < 400; ++k) {
    EXPECT_FALSE(reverses(recovery, 7, 0, 2, true));
    EXPECT_FALSE(recovery.leaving());
  }
  EXPECT_EQ(recovery.state(), DriveState::waiting);
  EXPECT_NEAR(waiting_time(recovery, 7), 0.7, 0.05) << "it is once the other has left";
}

TEST(Recovery, ReversesFurtherEachTimeUntilTheCarGetsOn) {
  Recovery recovery(small_car);
  waiting_time(recovery, 7);
  const double first = reversed_way(recovery, 7);
  waiting_time(recovery, 7);
  EXPECT_NEAR(reversed_way(recovery, 7) / first, 1.6, 0.1);
  for (int k = 0; k < 6; ++k) {
    waiting_time(recovery, 7);
    EXPECT_LT(reversed_way(recovery, 7), 3.05);
  }
  for (int k = 0; k < 200; ++k) reverses(recovery, 7 + 0.05 * k, 2);
  waiting_time(recovery, 17);
  EXPECT_NEAR(reversed_way(recovery, 17), first, 0.05);
}

TEST(Recovery, HalfOfAWayInReverseIsEnoughWhereTheWayOnIsFree) {
  Recovery recovery(small_car);
  waiting_time(recovery, 7);
  double way = 0;
  while (recovery.update({7 - way, -1, 2, length, false, true}, period) == DriveState::reversing)
    way += period;
  EXPECT_NEAR(way, 0.4, 0.05);
}

TEST(Recovery, ACarThatCannotReverseIsConfinedUntilItIsPastTheTrouble) {
  Recovery recovery(small_car);
  waiting_time(recovery, 7);
  EXPECT_EQ(recovery.margin_share(), 1) << "it reverses first";
  int blocked = 0;
  while (reverses(recovery, 7, 0)) ++blocked;
  EXPECT_NEAR(blocked * period, 0.7, 0.05) << "something stands behind it";
  EXPECT_EQ(recovery.margin_share(), 0.2);
  double arc = 7;
  for (; recovery.margin_share() < 1; arc += 0.05) EXPECT_FALSE(reverses(recovery, arc, 2));
  EXPECT_NEAR(arc, 11, 0.1);
}

TEST(Recovery, LeavesThePathUntilTheCarIsPastThePointWhereItStood) {
  Recovery recovery(small_car);
  for (int k = 0; k < 40; ++k) reverses(recovery, 6 + 0.025 * k, 1);
  EXPECT_FALSE(recovery.leaving());
  for (int k = 0; k < 18; ++k) EXPECT_FALSE(reverses(recovery, 7, 0));
  EXPECT_FALSE(recovery.leaving());
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(reverses(recovery, 7, 0));
  EXPECT_TRUE(recovery.leaving()) << "before it reverses";
  waiting_time(recovery, 7);
  reversed_way(recovery, 7);
  EXPECT_TRUE(recovery.retries());
  double arc = 6.2;
  for (; recovery.leaving(); arc += 0.05) EXPECT_FALSE(reverses(recovery, arc, 2));
  EXPECT_NEAR(arc, 11, 0.1);
  EXPECT_FALSE(recovery.retries());
}

TEST(Recovery, ACarCrawlsBelowTwoFifthsOfTheFreeSpeed) {
  for (const double speed : {0.7, 0.9}) {
    Recovery recovery(small_car);
    for (int k = 0; k < 100; ++k) reverses(recovery, speed * period * k, speed);
    EXPECT_EQ(recovery.leaving(), speed < 0.8);
  }
}

TEST(Recovery, TriesAgainUntilTheCarIsPastThePointHoweverSlowlyItDrives) {
  Recovery recovery(small_car);
  waiting_time(recovery, 7, 5);
  EXPECT_FALSE(recovery.retries()) << "it reverses first";
  double arc = 7 - reversed_way(recovery, 7, 5);
  for (; recovery.retries(); arc += period) EXPECT_FALSE(reverses(recovery, arc, 1, 5));
  EXPECT_NEAR(arc, 11, 0.1);
  EXPECT_TRUE(recovery.leaving()) << "it crawls still";
}

TEST(Recovery, NoticesACarThatDrivesInCircles) {
  Recovery recovery(small_car);
  bool reversed = false;
  int k = 0;
  for (; k < 200 && !reversed; ++k) reversed = reverses(recovery, 20 + 0.2 * std::sin(0.1 * k), 1.5);
  EXPECT_NEAR(k * period, 3, 0.1);
}

TEST(Recovery, ACarThatWasPutElsewhereHasNoTrouble) {
  Recovery recovery(small_car);
  waiting_time(recovery, 7);
  reversed_way(recovery, 7);
  reverses(recovery, -2, 0);
  EXPECT_TRUE(recovery.retries()) << "9 m back";
  reverses(recovery, -5, 0);
  EXPECT_FALSE(recovery.retries());
  EXPECT_FALSE(recovery.leaving());
}

/// A vehicle that only stands leaves every state within its limit, for the state that the limit names.
TEST(Recovery, NoStateStandsForEver) {
  RecoveryLengths robot{.progress = 0.1,
                        .relief = 0.5,
                        .jump = 100,
                        .standing = 0.02,
                        .stand_still = 4,
                        .patience = 4,
                        .wait = 10,
                        .attempts = 5};
  for (const RecoveryLengths& lengths : {small_car, robot})
    for (const bool waits : {false, true}) {
      Recovery recovery(lengths);
      DriveState before = DriveState::following;
      double since = 0;
      bool seen[6] = {};
      for (int k = 0; k < 8000; ++k, since += period) {
        if (k == 200) {
          recovery.begin_manoeuvre();
          before = DriveState::manoeuvring;
          since = 0;
        }
        const DriveState now = recovery.update({7, 0, 2, 0, waits}, period);
        seen[static_cast<int>(now)] = true;
        const Recovery::StandingLimit limit = recovery.standing_limit(before);
        ASSERT_LE(since, limit.time + 2 * period) << static_cast<int>(before);
        if (now == before && !recovery.begins()) continue;
        if (since > limit.time - period) {
          EXPECT_TRUE(now == limit.next || now == DriveState::stuck) << static_cast<int>(before);
        }
        before = now;
        since = 0;
      }
      EXPECT_EQ(seen[static_cast<int>(DriveState::stuck)], lengths.attempts == 5 && !waits);
      EXPECT_EQ(seen[static_cast<int>(DriveState::reversing)], lengths.longest > 0 && !waits);
      EXPECT_TRUE(seen[static_cast<int>(DriveState::retrying)]);
    }
}

}  // namespace
}  // namespace slalom::maps::recovery_test
