#include "slalom/maps/moving_obstacles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "support/predicted.hpp"
#include "support/rollouts.hpp"

namespace slalom::maps::moving_obstacles_test {
namespace {

/// With five poses of each hypothesis, 0.25 s apart.
struct Predicted : testing::Predicted {
  Predicted(double length, double width, const std::vector<Hypothesis>& hypotheses)
      : testing::Predicted(length, width, hypotheses, 5, 0.25) {}
};

/// A body of 0.6 m x 0.3 m round its reference point, which collides where it touches.
MovingObstacleOptions touching() {
  return {.front = 0.3, .rear = 0.3, .width = 0.3, .margin = 0, .soft_margin = 0.2, .soft_cost = 10};
}

Cost<double> cost_at(const MovingObstaclesView& view, const Pose& pose, int k = 0) {
  return view.cost(pose.x, pose.y, std::sin(pose.yaw), std::cos(pose.yaw), k);
}

/// Whether two boxes overlap, from their corners and sides.
bool overlap(const Pose& a, double la, double wa, const Pose& b, double lb, double wb) {
  const auto corner = [](const Pose& box, double length, double width, int i) {
    const double u = (i == 0 || i == 3 ? 0.5 : -0.5) * length, v = (i < 2 ? 0.5 : -0.5) * width;
    return transform(box, {u, v});
  };
  const auto inside = [](const Pose& box, double length, double width, const Point& point) {
    const Point own = inverse_transform(box, point);
    return std::abs(own.x) < 0.5 * length && std::abs(own.y) < 0.5 * width;
  };
  const auto side_of = [](const Point& from, const Point& to, const Point& point) {
    return (to.x - from.x) * (point.y - from.y) - (to.y - from.y) * (point.x - from.x) > 0;
  };
  for (int i = 0; i < 4; ++i) {
    const Point a0 = corner(a, la, wa, i), a1 = corner(a, la, wa, (i + 1) % 4);
    if (inside(b, lb, wb, a0) || inside(a, la, wa, corner(b, lb, wb, i))) return true;
    for (int j = 0; j < 4; ++j) {
      const Point b0 = corner(b, lb, wb, j), b1 = corner(b, lb, wb, (j + 1) % 4);
      if (side_of(a0, a1, b0) != side_of(a0, a1, b1) && side_of(b0, b1, a0) != side_of(b0, b1, a1))
        return true;
    }
  }
  return false;
}

TEST(MovingObstacles, CollideWhereTheBoxesOverlap) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1), size(0.05, 1.2), turn(-4, 4);
  MovingObstacles others(touching(), 1);
  int overlaps = 0;
  for (int i = 0; i < 20000; ++i) {
    const double length = size(random), width = size(random);
    const Pose body{place(random), place(random), turn(random)},
        box{place(random), place(random), turn(random)};
    const Predicted predicted(length, width, {{1, box}});
    others.update({&predicted.obstacle, 1}, {0, 0}, 0, 0.1);
    const bool expected = overlap(body, 0.6, 0.3, box, length, width);
    // Boxes are kept as float32: what touches within 1e-6 m is left to chance.
    if (overlap(body, 0.600001, 0.300001, box, length, width) !=
        overlap(body, 0.599999, 0.299999, box, length, width))
      continue;
    const Cost<double> cost = cost_at(others.view(), body);
    EXPECT_EQ(cost.collided, expected) << i;
    EXPECT_EQ(cost.value >= 100, expected) << i;
    overlaps += expected;
  }
  EXPECT_GT(overlaps, 4000);
  EXPECT_LT(overlaps, 16000);
}

TEST(MovingObstacles, HypothesesCountByTheirWeights) {
  MovingObstacleOptions options = touching();
  options.max_probability = 0.5;
  MovingObstacles others(options, 4);
  const Predicted predicted(0.6, 0.3, {{0.3, {0, 0, 0}}, {0.7, {0, 5, 0}}});
  others.update({&predicted.obstacle, 1}, {0, 0}, 0, 0.1);
  const Cost<double> at_first = cost_at(others.view(), {0, 0.1, 0}),
                     at_second = cost_at(others.view(), {0, 5, 1});
  EXPECT_NEAR(at_first.value, 30, 1e-4);
  EXPECT_FALSE(at_first.collided);
  EXPECT_NEAR(at_second.value, 70, 1e-4);
  EXPECT_TRUE(at_second.collided);
}

TEST(MovingObstacles, NearnessCostsAsTheSquareOfTheDistance) {
  MovingObstacles others(touching(), 1);
  const Predicted predicted(1, 1, {{1, {0, 0, 0}}});
  others.update({&predicted.obstacle, 1}, {0, 0}, 0, 0.1);
  EXPECT_NEAR(cost_at(others.view(), {0.9, 0, 0}).value, 2.5, 1e-3);  // a gap of 0.1 m, half of the margin
  EXPECT_EQ(cost_at(others.view(), {1.01, 0, 0}).value, 0);
  EXPECT_EQ(cost_at(others.view(), {0.9, 0, 0}, 1).collided, false);
}

TEST(MovingObstacles, BoxesGrowByTheirDeviations) {
  MovingObstacleOptions options = touching();
  options.deviations = 2;
  MovingObstacles others(options, 1);
  const Predicted predicted(1, 1, {{1, {0, 0, 0}, 0, 0.3, 0.1}});
  others.update({&predicted.obstacle, 1}, {0, 0}, 0, 0.1);
  EXPECT_TRUE(cost_at(others.view(), {1.39, 0, 0}).collided);  // 0.5 + 2 x 0.3 + 0.3
  EXPECT_FALSE(cost_at(others.view(), {1.41, 0, 0}).collided);
  EXPECT_TRUE(cost_at(others.view(), {0, 0.84, 0}).collided);  // 0.5 + 2 x 0.1 + 0.15
  EXPECT_FALSE(cost_at(others.view(), {0, 0.86, 0}).collided);
}

TEST(MovingObstacles, AreMetWhereTheyWillBe) {
  MovingObstacles others(touching(), 30);
  const Predicted predicted(0.6, 0.3, {{1, {1, 0, 0}, 2}});
  others.update({&predicted.obstacle, 1}, {0, 0}, 0.1, 0.05);
  for (const int k : {0, 1, 7, 20, 30}) {  // the predictions end after 1 s, k = 18
    const double x = 1 + 2 * (0.1 + 0.05 * k);
    EXPECT_TRUE(cost_at(others.view(), {x - 0.59, 0, 0}, k).collided) << k;
    EXPECT_FALSE(cost_at(others.view(), {x - 0.61, 0, 0}, k).collided) << k;
    EXPECT_TRUE(cost_at(others.view(), {x + 0.59, 0, 0}, k).collided) << k;
    EXPECT_FALSE(cost_at(others.view(), {x + 0.61, 0, 0}, k).collided) << k;
  }
}

TEST(MovingObstacles, ToEndBehindOneCostsWhatWasSetUntilItIsPassed) {
  MovingObstacles others(touching(), 10);
  // The likeliest hypothesis drives along y; the last step is 1 s ahead.
  const Predicted ahead(0.6, 0.3, {{0.3, {50, 50, 0}, 1}, {0.7, {0, 2, 0.5 * std::numbers::pi}, 0}}),
      other(0.6, 0.3, {{1, {0, 0, 0}}});
  const std::vector<PredictedObstacle> all{other.obstacle, ahead.obstacle};
  others.update(all, {0, 0}, 0, 0.1);
  EXPECT_EQ(others.view().following_cost(0.0, -8.0), 0);
  const std::vector<double> costs{0, 20};
  others.set_following_costs(costs);
  const MovingObstaclesView view = others.view();
  EXPECT_NEAR(view.following_cost(0.0, -8.0), 20, 1e-5);
  EXPECT_NEAR(view.following_cost(0.7, -2.0), 20, 1e-5);  // 4 m behind
  EXPECT_NEAR(view.following_cost(0.0, 0.5), 10, 1e-5);
  EXPECT_NEAR(view.following_cost(-3.0, 2.0), 4, 1e-5);
  EXPECT_EQ(view.following_cost(0.0, 3.01), 0);
  EXPECT_NEAR(view.relative_to({5, 5}).following_cost(-5.0, -4.5), 10, 1e-5);
  others.update(all, {0, 0}, 0, 0.1);
  EXPECT_EQ(others.view().following_cost(0.0, -8.0), 0) << "after the next update";
}

TEST(MovingObstacles, OneThatIsFarAwayAtTheLastStepIsNotFollowed) {
  MovingObstacles others(touching(), 10);
  const Predicted flies(0.6, 0.3, {{1, {2, 0, 0}, 1e40}});
  others.update({&flies.obstacle, 1}, {0, 0}, 0, 0.1);
  const std::vector<double> costs{20};
  others.set_following_costs(costs);
  EXPECT_EQ(others.view().following_cost(0.0, 0.0), 0);
}

/// A point that drives along x, among others.
struct Walker {
  template <class T>
  struct State {
    T x, y;
  };
  static constexpr int inputs = 2;
  static constexpr double dt = 0.1;
  MovingObstaclesView others{};

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    return {s.x + T(dt) * u[0], s.y + T(dt) * u[1]};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u, int k) const {
    const Cost<T> met = others.cost(s.x, s.y, T(0), T(1), k);
    return {square(u[0] - T(1)) + met.value, met.collided};
  }
};

TEST(MovingObstacles, EveryProblemMeetsThemInLanesAsInDouble) {
  constexpr int steps = 20, samples = 256;
  const Point far{5e6, -3e6};
  MovingObstacles others(touching(), steps);
  const Predicted one(0.6, 0.3,
                      {{0.6, {far.x + 3, far.y, 0.3}, -1, 0.1, 0.05}, {0.4, {far.x + 1, far.y + 1, 2}}}),
      other(0.5, 0.5, {{1, {far.x + 1.5, far.y - 0.5, 0}, 0.5}});
  const std::vector<PredictedObstacle> all{one.obstacle, other.obstacle};
  others.update(all, {far.x + 0.7, far.y}, 0.05, Walker::dt);
  Walker walker{others.view().relative_to(far)};
  SequenceBatch batch(steps, 2, samples);
  std::mt19937 random(5);
  std::normal_distribution<float> normal(0, 1);
  for (int i = 0; i < samples; ++i) {
    const float u = 1 + normal(random), v = normal(random);
    for (int k = 0; k < steps; ++k) {
      batch.at(k, 0, i) = u;
      batch.at(k, 1, i) = v;
    }
  }
  for (const simd::Target target : testing::instruction_sets()) {
    ProblemEvaluator<Walker> evaluator(walker, target);
    evaluator.set_state({0, 0});
    const auto [costs, collided] = testing::roll_out(evaluator, batch);
    int collisions = 0, differ = 0;
    for (int i = 0; i < samples; ++i) {
      const auto inputs = testing::inputs_of<2>(batch, i);
      const Cost<double> exact = predict(walker, {0.0, 0.0}, inputs.data(), steps, nullptr);
      // Rounding may move a state across the edge of a box.
      differ +=
          std::abs(costs[i] - exact.value) > 1e-3 * (1 + exact.value) || exact.collided != (collided[i] != 0);
      collisions += exact.collided;
    }
    EXPECT_LE(differ, 1);
    EXPECT_GT(collisions, samples / 8);
    EXPECT_LT(collisions, samples * 7 / 8);
  }
}

TEST(MovingObstacles, TheNearestCountAndBadNumbersDoNot) {
  MovingObstacles others(touching(), 1);
  std::vector<std::unique_ptr<Predicted>> made;
  std::vector<PredictedObstacle> all;
  for (int i = 0; i < MovingObstacles::max_count + 4; ++i) {
    const double x = 100 - 2.0 * i;
    made.push_back(std::make_unique<Predicted>(0.6, 0.3, std::vector<Predicted::Hypothesis>{{1, {x, 0, 0}}}));
    all.push_back(made.back()->obstacle);
  }
  others.update(all, {0, 0}, 0, 0.1);
  EXPECT_TRUE(cost_at(others.view(), {100 - 2.0 * (MovingObstacles::max_count + 3), 0, 0}).collided);
  EXPECT_TRUE(cost_at(others.view(), {100 - 2.0 * 4, 0, 0}).collided);
  EXPECT_FALSE(cost_at(others.view(), {100 - 2.0 * 3, 0, 0}).collided);

  const Predicted bad(0.6, 0.3, {{1, {std::numeric_limits<double>::quiet_NaN(), 0, 0}}});
  others.update({&bad.obstacle, 1}, {0, 0}, 0, 0.1);
  EXPECT_TRUE(others.view().empty());
  EXPECT_EQ(cost_at(others.view(), {0, 0, 0}).value, 0);
}

/// A square of 0.4 m that has one pose.
const testing::Predicted standing(0.4, 0.4, {{1, {3, 0, 0}}}, 1);

/// Readings that end on something that moves are dropped, whatever the turn of the scanner, and no others.
TEST(MovingReadings, AreDroppedAtTheObstacleAlone) {
  constexpr int beams = 360;
  const double increment = 2 * std::numbers::pi / beams;
  for (const double yaw : {0.0, 1.0, 3.1, -2.0}) {
    const Pose sensor{0, 0, yaw};
    std::vector<float> ranges(beams, 2.9f);  // on the obstacle ahead, elsewhere beside it
    ranges[0] = 5;
    const LaserScanView scan{ranges, -std::numbers::pi, increment, 0, 10};
    std::vector<float> kept = ranges;
    drop_readings_of(standing.obstacle, 0.1, sensor, scan, kept);
    for (int i = 0; i < beams; ++i) {
      const double angle = yaw - std::numbers::pi + i * increment, range = ranges[i];
      const bool on =
          std::abs(range * std::cos(angle) - 3) <= 0.3 && std::abs(range * std::sin(angle)) <= 0.3;
      EXPECT_EQ(std::isnan(kept[i]), on) << yaw << ", beam " << i;
    }
  }
}

TEST(MovingReadings, StayWhereBeamsRunClockwiseOrTheObstacleHasNoPoses) {
  const std::vector<float> ranges(360, 2.9f);
  std::vector<float> kept = ranges;
  drop_readings_of(standing.obstacle, 0.1, {}, {ranges, std::numbers::pi, -std::numbers::pi / 180, 0, 10},
                   kept);
  EXPECT_EQ(kept, ranges);
  drop_readings_of({}, 0.1, {}, {ranges, -std::numbers::pi, std::numbers::pi / 180, 0, 10}, kept);
  EXPECT_EQ(kept, ranges);
}

}  // namespace
}  // namespace slalom::maps::moving_obstacles_test
