#include "vehicle/planner/obstacles/pace_of_others.hpp"

#include <gtest/gtest.h>

#include "support/predicted.hpp"

namespace slalom::vehicle::detail::pace_of_others_test {
namespace {

constexpr double path_speed = 4;         // m/s
constexpr double period = 0.025;         // s
constexpr double steps_behind = 2000;    // time steps
constexpr maps::Point origin{100, -50};  // m, map frame

/// A straight path along x through the origin of the field's frame.
maps::ReferenceField straight_field() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 400; ++i) path.push_back({-20 + 0.1 * i, 0, 0, path_speed});
  maps::ReferenceField field(path);
  field.update({0, 0});
  return field;
}

/// A car at a pose (m, rad, field's frame) that drives at this speed (m/s) along its yaw. A second hypothesis
/// of less weight says that it stands.
struct PredictedCar : testing::Predicted {
  PredictedCar(int id, const maps::Pose& at, double speed)
      : Predicted(0.5, 0.3,
                  {{0.7, {origin.x + at.x, origin.y + at.y, at.yaw}, speed, 0.05, 0.02},
                   {0.3, {origin.x + at.x, origin.y + at.y, at.yaw}, 0, 0.05, 0.02}},
                  4) {
    obstacle.id = id;
  }
};

/// The steps lost behind one car after it was seen for some time (s), by a car at the field's origin.
double lost_behind(const PredictedCar& car, double seconds, const maps::Pose& own = {0, 0, 0}) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  const maps::PredictedObstacle* const all[] = {&car.obstacle};
  double lost = 0;
  for (double t = 0; t < seconds; t += period) lost = pace.steps_lost(all, field, origin, own)[0];
  return lost;
}

TEST(PaceOfOthers, BehindASlowerCarItsShareOfTheTimeIsLost) {
  EXPECT_NEAR(lost_behind(PredictedCar(1, {3, 0.2, 0}, 0.9 * path_speed), 30), 0.1 * steps_behind, 1);
  EXPECT_NEAR(lost_behind(PredictedCar(1, {3, 0.2, 0}, 0.4 * path_speed), 30), 0.25 * steps_behind, 1);
}

TEST(PaceOfOthers, NothingIsLostBehindACarAsFastAsThePath) {
  EXPECT_NEAR(lost_behind(PredictedCar(1, {3, 0, 0}, path_speed), 10), 0, 1e-6);
  EXPECT_EQ(lost_behind(PredictedCar(1, {3, 0, 0}, 1.2 * path_speed), 10), 0);
}

TEST(PaceOfOthers, ASpeedIsBelievedOnlyAfterSomeSeconds) {
  const PredictedCar car(1, {3, 0, 0}, 0.8 * path_speed);
  EXPECT_LT(lost_behind(car, period), 0.01 * 0.2 * steps_behind);
  EXPECT_NEAR(lost_behind(car, 3), (1 - std::exp(-1)) * 0.2 * steps_behind, 0.02 * steps_behind);
}

TEST(PaceOfOthers, ACarThatGetsUpToSpeedHasNotShownItsPace) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  double lost = 0;
  const auto drive = [&](double seconds, auto&& speed_after) {
    for (double t = 0; t < seconds; t += period) {
      const PredictedCar car(1, {3, 0, 0}, speed_after(t));
      const maps::PredictedObstacle* const all[] = {&car.obstacle};
      lost = pace.steps_lost(all, field, origin, {0, 0, 0})[0];
    }
  };
  drive(1, [](double t) { return 0.5 + t * (path_speed - 0.5); });
  EXPECT_EQ(lost, 0);
  drive(20, [](double) { return 0.8 * path_speed; });
  EXPECT_NEAR(lost, 0.2 * steps_behind, 0.01 * steps_behind) << "then it has";
}

TEST(PaceOfOthers, CarsThatAreNotFollowedCostNothing) {
  const double slow = 0.5 * path_speed;
  EXPECT_EQ(lost_behind(PredictedCar(1, {-2, 0, 0}, slow), 10), 0) << "behind";
  EXPECT_EQ(lost_behind(PredictedCar(1, {12, 0, 0}, slow), 10), 0) << "far ahead";
  EXPECT_EQ(lost_behind(PredictedCar(1, {3, 4, 0}, slow), 10), 0) << "far to the side";
  EXPECT_EQ(lost_behind(PredictedCar(1, {3, 0, 3}, slow), 10), 0) << "oncoming";
  EXPECT_EQ(lost_behind(PredictedCar(1, {3, 0, 0}, slow), 10, {0, 0, 2}), 0) << "the own car turns away";
  EXPECT_GT(lost_behind(PredictedCar(1, {3, 0, 0}, slow), 10), 0);
}

TEST(PaceOfOthers, EveryCarIsRememberedByItself) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  const PredictedCar slow(1, {3, 0, 0}, 0.8 * path_speed), fast(2, {5, 0, 0}, path_speed);
  const maps::PredictedObstacle* const both[] = {&slow.obstacle, &fast.obstacle};
  const maps::PredictedObstacle* const swapped[] = {&fast.obstacle, &slow.obstacle};
  for (int i = 0; i < 1200; ++i) pace.steps_lost(both, field, origin, {0, 0, 0});
  const auto lost = pace.steps_lost(swapped, field, origin, {0, 0, 0});
  EXPECT_NEAR(lost[0], 0, 1e-6);
  EXPECT_NEAR(lost[1], 0.2 * steps_behind, 1);
  pace.reset();
  EXPECT_LT(pace.steps_lost(swapped, field, origin, {0, 0, 0})[1], 0.01 * steps_behind);
}

TEST(PaceOfOthers, TheCarSeenLongestAgoGivesItsPlaceToANewOne) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  const PredictedCar kept(1, {3, 0, 0}, 0.8 * path_speed);
  const maps::PredictedObstacle* const one[] = {&kept.obstacle};
  for (int i = 0; i < 1200; ++i) pace.steps_lost(one, field, origin, {0, 0, 0});
  for (int id = 2; id < 60; ++id) {
    const PredictedCar other(id, {4, 0, 0}, path_speed);
    const maps::PredictedObstacle* const both[] = {&other.obstacle, &kept.obstacle};
    EXPECT_NEAR(pace.steps_lost(both, field, origin, {0, 0, 0})[1], 0.2 * steps_behind, 1) << id;
  }
}

}  // namespace
}  // namespace slalom::vehicle::detail::pace_of_others_test
