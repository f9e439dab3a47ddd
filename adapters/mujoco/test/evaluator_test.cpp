#include "slalom/mujoco/evaluator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <vector>

#include "models.hpp"
#include "slalom/slalom.hpp"
#include "support/allocations.hpp"

namespace slalom::mujoco::testing {
namespace {

constexpr int steps = 12;

SequenceBatch some_inputs(int samples, float scale = 1) {
  SequenceBatch batch(steps, 1, samples);
  for (int step = 0; step < steps; ++step)
    for (int k = 0; k < samples; ++k)
      batch.at(step, 0, k) = scale * std::sin(0.7f * static_cast<float>(step) + static_cast<float>(k));
  return batch;
}

struct Costs {
  std::vector<float> values;
  std::vector<std::uint8_t> collided;
};

template <class E>
Costs evaluate(const E& evaluator, const SequenceBatch& batch) {
  const auto size = static_cast<std::size_t>(batch.stride());
  Costs costs{std::vector<float>(size), std::vector<std::uint8_t>(size)};
  evaluator.evaluate(batch, 0, batch.samples(), costs.values.data(), costs.collided.data());
  return costs;
}

TEST_F(ModelTest, PredictsTheStatesOfMuJoCosOwnSteps) {
  const Model model = load(ball());
  const Evaluator evaluator(model, Reach{}, {.physics_steps = 4});
  using State = decltype(evaluator)::State;
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model.get()), mj_deleteData);
  data->qpos[0] = 0.3, data->qpos[1] = -0.85, data->qvel[0] = -0.2;  // it falls to the floor and slides
  const State start = evaluator.state_of(*data);
  std::vector<Input<double, 1>> u(200);
  for (std::size_t k = 0; k < u.size(); ++k) u[k][0] = std::sin(0.1 * static_cast<double>(k));
  std::vector<State> x(u.size() + 1);
  evaluator.predict(start, u.data(), static_cast<int>(u.size()), x.data());
  bool touched = false;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const State now = evaluator.state_of(*data);
    ASSERT_EQ(x[k].time, now.time);
    for (int i = 0; i < State::size; ++i) ASSERT_EQ(x[k].values[i], now.values[i]) << "step " << k;
    data->ctrl[0] = u[k][0];
    for (int physics = 0; physics < 4; ++physics) mj_step(&model.get(), data.get());
    touched = touched || data->ncon > 0;
  }
  EXPECT_TRUE(touched);
}

TEST_F(ModelTest, CostsSeeTheStateAndTheInputsOfTheirStep) {
  const Reach task{.goal = 0.4, .wall = 0.31};
  Evaluator evaluator(load(ball()), task, {.physics_steps = 5});
  decltype(evaluator)::State start;
  start.positions()[0] = 0.3;
  start.velocities()[0] = 0.1;
  Input<double, 1> u[steps];
  const SequenceBatch batch = some_inputs(1);
  for (int k = 0; k < steps; ++k) u[k][0] = static_cast<double>(batch.at(k, 0, 0));
  decltype(evaluator)::State x[steps + 1];
  const Cost<double> predicted = evaluator.predict(start, u, steps, x);
  double expected = 10 * std::abs(x[steps].positions()[0] - task.goal);
  for (int k = 0; k < steps; ++k)
    expected += std::pow(x[k].positions()[0] - task.goal, 2) + 0.01 * u[k][0] * u[k][0];
  EXPECT_NEAR(predicted.value, expected, 1e-12);
  EXPECT_TRUE(predicted.collided);  // on the way, not at the start
  EXPECT_LT(x[0].positions()[0], task.wall);

  evaluator.set_state(start);
  const Costs costs = evaluate(evaluator, batch);
  EXPECT_EQ(costs.values[0], static_cast<float>(predicted.value));
  EXPECT_EQ(costs.collided[0], 1);
}

TEST_F(ModelTest, TheCostsDoNotDependOnTheThreads) {
  const Model model = load(ball());
  const SequenceBatch batch = some_inputs(100);
  Evaluator one(model, Reach{});
  Evaluator three(model, Reach{}, {.threads = 3});
  one.set_state({});
  three.set_state({});
  const Costs expected = evaluate(one, batch);
  for (int repetition = 0; repetition < 20; ++repetition) {
    const Costs costs = evaluate(three, batch);
    ASSERT_EQ(costs.values, expected.values);
    ASSERT_EQ(costs.collided, expected.collided);
  }
  EXPECT_EQ(one.rollouts().simulated, 100);
  EXPECT_EQ(three.rollouts().simulated, 20 * 100);
}

/// The first inputs of three solves. Expects that these allocate nothing.
std::vector<double> solved_inputs(const Model& model, int threads, const long& allocations_of_mujoco) {
  Controller controller{Evaluator{model, Reach{}, {.physics_steps = 5, .threads = threads}},
                        SvgMppiOptions{.horizon = 20, .samples = 64}};
  std::vector<double> inputs(3);
  const long before = slalom::testing::allocations(), before_of_mujoco = allocations_of_mujoco;
  EXPECT_GT(before_of_mujoco, 0);
  for (double& input : inputs) {
    const auto plan = controller.solve({}, {.elapsed = 0.01});
    EXPECT_EQ(plan.status, Status::ok);
    EXPECT_EQ(plan.corrections, 0);
    input = plan.inputs[0][0];
  }
  EXPECT_EQ(slalom::testing::allocations(), before);
  EXPECT_EQ(allocations_of_mujoco, before_of_mujoco);
  return inputs;
}

TEST_F(ModelTest, ASolveAllocatesNothingAndGivesTheSamePlanOnAnyNumberOfThreads) {
  static long allocations_of_mujoco = 0;
  mju_user_malloc = [](std::size_t size) {
    ++allocations_of_mujoco;
    return std::aligned_alloc(64, (size + 63) / 64 * 64);
  };
  const Model model = load(ball());
  EXPECT_EQ(solved_inputs(model, 1, allocations_of_mujoco), solved_inputs(model, 3, allocations_of_mujoco));
  mju_user_malloc = nullptr;
}

TEST_F(ModelTest, ACopyOfAControllerGoesOnWithTheSameBits) {
  Controller controller{Evaluator{load(ball()), Reach{}, {.physics_steps = 5, .threads = 2}},
                        SvgMppiOptions{.horizon = 20, .samples = 64}};
  controller.solve({}, {.elapsed = 0.01});
  Controller copy = controller;
  for (int solve = 0; solve < 3; ++solve) {
    const auto plan = controller.solve({}, {.elapsed = 0.01}), same = copy.solve({}, {.elapsed = 0.01});
    for (std::size_t k = 0; k < plan.inputs.size(); ++k) ASSERT_EQ(plan.inputs[k][0], same.inputs[k][0]);
  }
}

/// Expects that sequence 1 of 3 has an infinite cost and collides, and that those beside it are as if alone.
void expect_second_invalid(const Model& model, float input) {
  const SequenceBatch quiet = some_inputs(3, 0);
  SequenceBatch batch = some_inputs(3, 0);
  for (int step = 4; step < steps; ++step) batch.at(step, 0, 1) = input;
  Evaluator evaluator(model, Reach{}, {.physics_steps = 10});
  evaluator.set_state({});
  const Costs alone = evaluate(evaluator, quiet), costs = evaluate(evaluator, batch);
  EXPECT_EQ(evaluator.rollouts().invalid, 1);
  EXPECT_EQ(costs.values[1], std::numeric_limits<float>::infinity());
  EXPECT_EQ(costs.collided[1], 1);
  for (const std::size_t k : {0u, 2u}) {
    EXPECT_TRUE(std::isfinite(costs.values[k]));
    EXPECT_EQ(costs.values[k], alone.values[k]);
    EXPECT_EQ(costs.collided[k], 0);
  }
}

TEST_F(ModelTest, ARolloutThatDivergesCollidesAndMuJoCoWritesNoLog) {
  std::filesystem::current_path(folder_);
  expect_second_invalid(load(ball("", "<motor joint='slide' gear='1e20'/>")), 1);
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

TEST_F(ModelTest, ARolloutWhoseConstraintsDoNotFitCollides) {
  std::filesystem::current_path(folder_);
  // The motor pushes the ball down to the floor, whose contact has more constraints than there is room for.
  expect_second_invalid(load(ball("<option gravity='0 0 0'/><size njmax='1'/>", "<motor joint='height'/>")),
                        -2000);
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

TEST_F(ModelTest, AnErrorOfMuJoCoInARolloutIsACollision) {
  // With the stack that this model has, the solver of the contact fails: by itself MuJoCo ends the program.
  expect_second_invalid(load(ball("<option gravity='0 0 0'/><size nstack='50'/>", "<motor joint='height'/>")),
                        -2000);
}

TEST_F(ModelTest, APlanThatDivergesIsFiniteAndSaysSo) {
  const Model model = load(ball("", "<motor joint='slide' gear='1e20' ctrllimited='true' ctrlrange='1 2'/>"));
  Controller controller{Evaluator{model, Reach{}}, MppiOptions{.horizon = 20, .samples = 16}};
  const auto plan = controller.solve({});
  EXPECT_EQ(plan.status, Status::degenerate);
  EXPECT_TRUE(plan.collided);
  for (const Input<double, 1>& u : plan.inputs) EXPECT_TRUE(u[0] >= 1 && u[0] <= 2);
  for (const auto& x : plan.states)
    for (const double value : x.values) EXPECT_TRUE(std::isfinite(value));
}

struct Filtered : Reach {
  static constexpr int activations = 1;
};

TEST_F(ModelTest, ActivationsArePartOfTheState) {
  const Model model = load(ball("", "<general joint='slide' dyntype='filter' dynprm='0.1'/>"));
  const Evaluator evaluator(model, Filtered{}, {.physics_steps = 10});
  using State = decltype(evaluator)::State;
  State start, x[3];
  start.activations()[0] = 1;
  const Input<double, 1> u[2] = {{0}, {0}};
  evaluator.predict(start, u, 2, x);
  EXPECT_GT(x[2].velocities()[0], 0);  // the motor still pushes
  EXPECT_NEAR(x[2].activations()[0], std::exp(-0.04 / 0.1), 0.01);
}

}  // namespace
}  // namespace slalom::mujoco::testing
