// The blocks of a message about a solve: effective sample sizes, inputs of each step, costs of each step.
#include "view/protocol/blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "slalom/problems/differential_drive.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/registry.hpp"
#include "view/protocol/frame_reader.hpp"

namespace slalom::view {
namespace {

using problems::DifferentialDrive;

/// The third solve of a robot among discs.
class Solve : public ::testing::TestWithParam<const char*> {
 protected:
  Solve() {
    for (int i = 0; i < 3; ++i) controller_.solve({0.2 * i, 0, 0}, {.elapsed = i ? 0.1 : 0});
  }
  static SolverOptions options() {
    SolverOptions all = solver_options(GetParam());
    *all.find<int>("samples") = 500;
    if (int* steps = all.find<int>("guide_iterations")) *steps = 5;
    *all.find<PerInput>("input_min") = {0, -2};
    *all.find<PerInput>("input_max") = {1.5, 2};
    return all;
  }
  const SolveResult& result() const { return controller_.solver().result(); }

  Controller<DifferentialDrive> controller_{DifferentialDrive{}, options()};
};

TEST_P(Solve, TheEffectiveSampleSizeIsTheSolversAtItsTemperatureAndRisesWithIt) {
  FrameWriter to;
  put_effective_samples(to, result());
  const std::string message = to.take();
  const std::string_view block = FrameReader(message).block(Block::effective_samples);
  ASSERT_EQ(block.size(), 13 * 2 * sizeof(float));
  PayloadReader from(block);
  double before = 0;
  for (int i = 0; i < 13; ++i) {
    const double temperature = from.f32(), size = from.f32();
    if (i == 6) {
      EXPECT_NEAR(temperature, result().temperature, 1e-6 * temperature);
      EXPECT_NEAR(size, result().effective_sample_size, 1e-3 * size);
    }
    EXPECT_GE(size, before);
    EXPECT_LE(size, 500);
    before = size;
  }
}

TEST_P(Solve, TheInputsAreThoseOfPlanNominalAndGuide) {
  FrameWriter to;
  put_inputs(to, result(), 2);
  const std::string message = to.take();
  PayloadReader from(FrameReader(message).block(Block::inputs));
  const std::size_t steps = from.get<std::uint16_t>(), inputs = from.get<std::uint16_t>();
  ASSERT_EQ(steps * inputs, result().inputs.size());
  for (const float value : result().inputs) EXPECT_EQ(from.get<float>(), value);
  for (const float value : result().nominal) EXPECT_EQ(from.get<float>(), value);
  if (result().guides.sequences == 0) return;
  // A position of one of the guides after its first step, which later steps have changed.
  const auto first = result().guide_path.values.first(result().guides.values.size());
  std::vector<float> before(steps * inputs);
  for (float& value : before) value = from.get<float>();
  EXPECT_NE(std::search(first.begin(), first.end(), before.begin(), before.end()), first.end());
  EXPECT_FALSE(std::equal(before.begin(), before.end(), result().nominal.begin()));
}

INSTANTIATE_TEST_SUITE_P(Methods, Solve, ::testing::Values("svg_mppi", "mppi"));

TEST(StepCosts, AProblemWithoutTermsHasNone) {
  FrameWriter to;
  put_step_costs(to, {}, 0, 5);
  const std::string message = to.take();
  EXPECT_EQ(FrameReader(message).block(Block::step_costs).size(), 2 * sizeof(std::uint16_t));
}

}  // namespace
}  // namespace slalom::view
