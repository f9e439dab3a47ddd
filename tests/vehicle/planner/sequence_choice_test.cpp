// The choice of the sequence that is sent, where the solution is not the best one known.
#include "vehicle/planner/sequence_choice.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"
#include "support/lane.hpp"
#include "support/predicted.hpp"

namespace slalom::vehicle::detail::sequence_choice_test {
namespace {

constexpr int horizon = 20;
constexpr double time_step = 0.05;  // s

/// A car on a straight course, and the sequences that it may send.
class SequenceSelection : public ::testing::Test {
 protected:
  explicit SequenceSelection(Objective objective = Objective::path_speed, double margin = 0.04)
      : field_(testing::lane(5)) {
    VehicleOptions car;
    car.model = vehicle_model("single_track");
    car.max_acceleration = car.max_deceleration = 9;
    car.body.margin = margin;
    car.own_of<SingleTrackOptions>().objective = objective;
    model_ = make_vehicle_model(car);
    choice_.emplace(horizon, 2, model_->traits());
    field_.update({10, 0});
    drive(4);
  }

  /// Lets the car drive at this speed (m/s) among the points seen so far.
  void drive(double speed, const maps::MovingObstaclesView& others = {}) {
    const VehicleMaps maps{field_.view(), clearance_.view(), {10, 0, 0}, others};
    model_->set_maps(maps);
    model_->set_start({{10, 0, 0}, speed}, 5);
    choice_->sees(maps);
  }
  /// Begins with a solution.
  const SequenceChoice::Choice& begin(const std::vector<float>& solution) {
    result_.inputs = solution;
    choice_->begin(*model_, result_);
    return choice_->best();
  }
  const SequenceChoice::Choice& kept_or(const std::vector<float>& solution, double elapsed) {
    begin(solution);
    choice_->consider_last(elapsed);
    return choice_->best();
  }
  /// Steering (rad) in every step, and an acceleration (m/s^2) that rises by `rise` from step to step.
  static std::vector<float> sequence(float steer, float acceleration = 1, float rise = 0.1f) {
    std::vector<float> inputs;
    for (int k = 0; k < horizon; ++k)
      inputs.insert(inputs.end(), {steer, acceleration + rise * static_cast<float>(k)});
    return inputs;
  }

  maps::ReferenceField field_;
  maps::ClearanceMap clearance_{{.length_x = 20, .center_x = 8}};
  std::unique_ptr<VehicleModel> model_;
  SolveResult result_;
  std::optional<SequenceChoice> choice_;
};

TEST_F(SequenceSelection, KeepsThePlanWhereTheSolutionIsWorse) {
  const auto sent = sequence(0), solution = sequence(0.4f);
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data()) << "nothing was sent before";
  choice_->sent(sent);
  const auto chosen = kept_or(solution, 1.2 * time_step);
  ASSERT_EQ(chosen.inputs.size(), sent.size());
  for (int k = 0; k < horizon; ++k) {
    const auto row = static_cast<std::size_t>(2 * k);
    EXPECT_EQ(chosen.inputs[row], 0);
    // 1.2 steps later, with the last input held.
    EXPECT_NEAR(chosen.inputs[row + 1], std::min(1 + 0.1 * (k + 1.2), 1 + 0.1 * (horizon - 1)), 1e-6) << k;
  }
  std::vector<PredictedState> states(horizon + 1);
  EXPECT_EQ(model_->predict(chosen.inputs, states).state, chosen.cost.state);
  EXPECT_EQ(states.back().pose.x, choice_->states().back().pose.x) << "the prediction is that of the choice";
  choice_->reset();
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data()) << "forgotten";
}

TEST_F(SequenceSelection, TakesTheSolutionWhereItIsBetter) {
  const auto sent = sequence(0.4f), solution = sequence(0);
  choice_->sent(sent);
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data());
}

/// A car at 6 m/s in whose way there may be walls.
class PlanNearAWall : public SequenceSelection {
 protected:
  explicit PlanNearAWall(Objective objective = Objective::lap_time) : SequenceSelection(objective, 0.05) {}

  /// A wall from one point to another, m in the frame of the car.
  void see_wall(maps::Point from, maps::Point to, const maps::MovingObstaclesView& others = {}) {
    std::vector<maps::Point> points;
    for (int i = 0; i <= 200; ++i)
      points.push_back({from.x + (to.x - from.x) * i / 200, from.y + (to.y - from.y) * i / 200});
    clearance_.add(points);
    drive(6, others);
  }
  static std::vector<float> held(float steer, float acceleration) { return sequence(steer, acceleration, 0); }
  /// Whether the model and the choice say that the car collides if it drives straight on.
  std::pair<bool, bool> collides() {
    const auto straight_on = held(0, 0);
    std::vector<PredictedState> states(horizon + 1);
    return {model_->predict(straight_on, states).collided, begin(straight_on).cost.collided};
  }
  /// Expects that a plan collides with a post that is ahead of the body in one state, behind it in the next.
  void expect_post_is_seen() {
    const auto braking = held(0, -9);
    for (const auto& [beside, met] : {std::pair(0.15, true), {0.3, false}}) {
      clearance_.clear();
      clearance_.add(std::vector<maps::Point>{{0.62, beside}});
      drive(18);
      std::vector<PredictedState> states(horizon + 1);
      EXPECT_FALSE(model_->predict(braking, states).collided) << beside;
      EXPECT_EQ(begin(braking).cost.collided, met) << beside;
    }
  }
  SequenceChoice::Choice chosen_for(const std::vector<float>& solution) {
    EXPECT_TRUE(begin(solution).cost.collided);
    choice_->sent(solution);
    choice_->consider_last(0);
    choice_->consider_samples();
    if (choice_->best().cost.collided) choice_->stop(false);
    return choice_->best();
  }
};

struct PathSpeeds : PlanNearAWall {
  PathSpeeds() : PlanNearAWall(Objective::path_speed) {}
};

// The body's discs have a radius of 0.18 m; the wall is 0.02 to 0.04 m from them, and the margin 0.05 m.
TEST_F(PlanNearAWall, PaysForTheMarginOfTheBody) {
  see_wall({2, 0.2}, {6, 0.2});
  EXPECT_EQ(collides(), std::pair(true, false));
  EXPECT_GE(choice_->best().cost.collision, 100) << "the cost of a collision remains";
}

/// Another car as it stands on the way, 3 m ahead and `offset` m to the left.
struct Standing : testing::Predicted {
  explicit Standing(double offset)
      : Predicted(0.58, 0.31, {{1, {13, offset, 0}, 0, 0.02, 0.02}}, 3),
        obstacles(maps::MovingObstacleOptions{}, horizon) {
    obstacles.update({&obstacle, 1}, {10, 0}, 0, time_step);
  }
  maps::MovingObstacles obstacles;
};

TEST_F(PlanNearAWall, PaysForTheMarginOfTheBodyAmongOthersToo) {
  for (const auto& [offset, collided] : {std::pair(-0.5, false), {-0.1, true}}) {
    const Standing other(offset);
    see_wall({2, 0.2}, {6, 0.2}, other.obstacles.view());
    EXPECT_EQ(collides(), std::pair(true, collided)) << "what moves is not in the clearances";
  }
}

TEST_F(PlanNearAWall, CollidesWithTheBodyItself) {
  see_wall({4, -2}, {4, 2});
  EXPECT_EQ(collides(), std::pair(true, true));
}

TEST_F(PathSpeeds, ACarThatFollowsThemKeepsTheMargin) {
  see_wall({2, 0.2}, {6, 0.2});
  EXPECT_EQ(collides(), std::pair(true, true));
}

// At 18 m/s a car of 0.58 m drives 0.9 m in a step.
TEST_F(PlanNearAWall, SeesWhatTheBodyTouchesBetweenTwoPoses) {
  expect_post_is_seen();
}
TEST_F(PathSpeeds, SeeWhatTheBodyTouchesBetweenTwoPoses) {
  expect_post_is_seen();
}

TEST_F(PathSpeeds, ACarWithItsNoseAtAWallDoesNotDriveThroughIt) {
  see_wall({0.5, -1}, {0.5, 1});
  drive(0);
  EXPECT_TRUE(begin(sequence(0, 5, 0)).cost.collided);
}

TEST_F(PlanNearAWall, BrakesBeforeAWallAcrossTheWay) {
  see_wall({2.8, -3}, {2.8, 3});
  const auto solution = held(0.2f, 0);
  begin(solution);
  const double speed = choice_->states().back().speed;
  EXPECT_LT(chosen_for(solution).inputs[1], -5);
  EXPECT_LT(choice_->states().back().speed, 0.5 * speed);
}

// The car is about to touch the wall beside it. Brakes would turn it into the wall and hardly slow it down.
TEST_F(PlanNearAWall, ContinuesWhereBrakingComesTooLate) {
  see_wall({0.9, 0.12}, {2, 0.12});
  const auto chosen = chosen_for(held(0, 1));
  for (std::size_t k = 0; k < horizon; ++k) EXPECT_EQ(chosen.inputs[2 * k + 1], 1) << k;
}

}  // namespace
}  // namespace slalom::vehicle::detail::sequence_choice_test
