// A copy of a planner goes on with the same bits, and shares nothing with the original.
#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::vehicle::copy_test {
namespace {

Planner planner_of(const std::string& model, Objective objective) {
  VehicleOptions car;
  car.model = vehicle_model(model);
  PlannerOptions options;
  if (model == "single_track") {
    car.own_of<SingleTrackOptions>().objective = objective;
    options.sight_deceleration = 4;
    options.time_behind = 2;
  }
  return {options, make_vehicle_model(car), testing::lane(3),
          make_solver(testing::few_samples("svg_mppi"), input_count(car))};
}

/// The inputs of one update after another: a car that drives along the lane, stops at a wall and leaves it.
class Inputs {
 public:
  PlannerInput at(int i) {
    const double near = i > 40 ? 0.45 : 6, time = 0.025 * i;
    for (std::size_t k = 0; k < ranges_.size(); ++k)
      ranges_[k] = static_cast<float>(near + 0.3 * std::sin(0.1 * static_cast<double>(k) + time));
    const double x = 5 + (i > 40 ? 3 : 3 * time);
    for (std::size_t k = 0; k < poses_.size(); ++k)
      poses_[k].pose = {x + 3 + 0.1 * static_cast<double>(k), 0.2, 0};
    other_.poses = poses_;
    PlannerInput input{.scan = {ranges_, -2.35, 4.7 / 270, 0.05, 30},
                       .odometry = {{x, 0.1 * std::sin(time), 0.05}, i > 40 ? 0.0 : 3.0}};
    input.odometry.covariance = {{{1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1e-4}}};
    input.imu = {0.1, 0.2, 0.05};
    if (i < 60) input.others = {&other_, 1};
    return input;
  }

 private:
  std::vector<float> ranges_ = std::vector<float>(271);
  std::array<maps::PredictedPose, 10> poses_{};
  maps::PredictedObstacle other_{
      .id = 1, .length = 0.5, .width = 0.3, .interval = 0.1, .hypotheses = 1, .weights = {1}, .poses = {}};
};

/// The part of an output that must not differ.
struct Sent {
  std::vector<double> values;

  explicit Sent(const PlannerOutput& out)
      : values{out.command.steer,  out.command.speed, out.state_cost,         out.collision_cost,
               out.steer_estimate, out.slip_estimate, out.parameters.friction} {
    values.insert(values.end(), out.inputs.begin(), out.inputs.end());
    for (const PredictedState& s : out.predicted)
      values.insert(values.end(), {s.pose.x, s.pose.y, s.pose.yaw, s.speed, s.steer, s.yaw_rate});
  }
  bool operator==(const Sent&) const = default;
};

class CopiedPlanner : public ::testing::TestWithParam<const char*> {};

TEST_P(CopiedPlanner, GoesOnWithTheSameBits) {
  const std::string name = GetParam();
  const bool for_time = name == "single_track_for_time";
  const Objective objective = for_time ? Objective::lap_time : Objective::path_speed;
  Inputs inputs;
  std::optional<Planner> original = planner_of(for_time ? "single_track" : name, objective);
  for (int begin = 0; begin < 280; begin += 35) {
    for (int i = begin; i < begin + 20; ++i) original->update(inputs.at(i));
    std::optional<Planner> copy = original;
    std::vector<PredictedState> states(7), same(7);
    const std::vector<float> sequence(static_cast<std::size_t>(6 * original->solver().inputs()), 0.1f);
    EXPECT_EQ(copy->predict(sequence, same).state, original->predict(sequence, states).state);
    EXPECT_EQ(same.back().pose.x, states.back().pose.x);
    std::vector<Sent> sent;
    for (int i = begin + 20; i < begin + 35; ++i) {
      const PlannerInput input = inputs.at(i);
      const long before = testing::allocations();
      ASSERT_GT(before, 0) << "nothing is counted";
      const PlannerOutput& out = copy->update(input);
      EXPECT_EQ(testing::allocations(), before) << "update " << i;
      sent.emplace_back(out);
    }
    copy.reset();
    for (int i = begin + 20; i < begin + 35; ++i)
      EXPECT_EQ(Sent(original->update(inputs.at(i))), sent[i - begin - 20]) << i;
    original = Planner(*original);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, CopiedPlanner,
                         ::testing::Values("kinematic", "kinematic_acceleration", "single_track",
                                           "single_track_for_time", "published"),
                         [](const auto& model) { return std::string(model.param); });

}  // namespace
}  // namespace slalom::vehicle::copy_test
