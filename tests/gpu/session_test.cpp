#include <gtest/gtest.h>

#include "fake_cuda.hpp"
#include "slalom/gpu/gpu.hpp"
#include "slalom/problems/pendulum.hpp"

namespace slalom::gpu {

using problems::Pendulum;

template <>
std::span<const Image> images<Pendulum>() {
  static const Image all[] = {{90}};
  return all;
}

namespace {

/// A driver whose kernels do nothing.
class GpuErrors : public ::testing::Test {
 protected:
  GpuErrors() {
    fake_query = fake_allocation = 0;
    const int layout[] = {sizeof(Pendulum), alignof(Pendulum), sizeof(Arguments<Pendulum>), 1};
    std::copy_n(layout, 4, fake_layout);
  }
  const MppiOptions options_{.horizon = 10, .samples = 64, .temperature = 1};
};

TEST_F(GpuErrors, ThereMustBeCodeOfThisVersionAndMemory) {
  EXPECT_THROW(Session({}, {}), DeviceError);
  fake_allocation = 2;
  EXPECT_THROW((GpuSolver<Pendulum, MppiOptions>(options_)), DeviceError);
  fake_allocation = 0, ++fake_layout[2];
  EXPECT_THROW((GpuSolver<Pendulum, MppiOptions>(options_)), DeviceError);
}

TEST_F(GpuErrors, AProblemThatComputesSomethingElseIsRefused) {
  EXPECT_THROW(Mppi<Pendulum>(Pendulum{}, options_), std::invalid_argument);
}

TEST_F(GpuErrors, ASolveEndsWithItsDeadlineAndWhenTheDeviceIsLost) {
  GpuSolver<Pendulum, MppiOptions> solver(options_);
  ProblemEvaluator<Pendulum> evaluator{{}};
  fake_query = 600;
  EXPECT_EQ(solver.solve(evaluator, {.deadline = 0.01}).status, Status::deadline);
  EXPECT_EQ(solver.session().fault(), "");
  fake_query = 700;
  EXPECT_EQ(solver.solve(evaluator, {}).status, Status::degenerate);
  EXPECT_EQ(solver.session().fault(), "GPU: kernel: fake failure");
  EXPECT_EQ(solver.solve(evaluator, {}).status, Status::degenerate);
  EXPECT_EQ(solver.result().inputs.size(), 10u);
}

TEST_F(GpuErrors, NothingWaitsForADeviceThatNeverEnds) {
  const auto start = std::chrono::steady_clock::now();
  {
    GpuSolver<Pendulum, MppiOptions> solver(options_);
    fake_query = 600;
    solver.reset(1);
    EXPECT_EQ(solver.session().fault(), "GPU: kernel: fake failure");
    EXPECT_THROW(solver.clone(), DeviceError);
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 10);
}

}  // namespace
}  // namespace slalom::gpu
