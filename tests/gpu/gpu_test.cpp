#include <gtest/gtest.h>

#include <numbers>

#include "gpu/emulation.hpp"
#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/passing_point.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"
#include "solvers/closed_form.hpp"
#include "support/thrown_words.hpp"

namespace slalom::gpu {

using namespace problems;

/// A problem with memory of its own.
struct WithMemory : Pendulum {
  std::vector<float> weights{1, 2, 3};
  const float* other = nullptr;
  template <class V>
  void visit_memory(V&& visit) const {
    visit(weights);
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>& u) const {
    return T(weights.data()[2]) * square(x.rate) + square(u[0]);
  }
  template <class T>
  T terminal_cost(const State<T>&) const {
    return T(0);
  }
};

namespace {

constexpr unsigned char code[1] = {};

void ignore(const char*, int, int, const void*) {}

/// Drives with the processor's solver and with the emulated one, with the same seed, and compares the plans.
template <class P, class Options>
void compare(const P& problem, const Options& options, typename P::template State<double> x, int solves) {
  fake_launch = &emulate<P>;
  Controller<P> processor(problem, options);
  GpuController<P, Options> gpu(problem, options);
  for (int n = 0; n < solves; ++n) {
    const Plan<P> expected = processor.solve(x, {.elapsed = problem.dt}),
                  plan = gpu.solve(x, {.elapsed = problem.dt});
    double difference = 0;
    for (int k = 0; k < options.horizon; ++k)
      for (int i = 0; i < P::inputs; ++i)
        difference = std::max(difference, std::abs(plan.inputs[k][i] - expected.inputs[k][i]) /
                                              std::min(options.input_max[i] - options.input_min[i], 10.0));
    EXPECT_LT(difference, 2e-4) << "of the range, or of 10; " << Options::method << ", " << options.samples
                                << " samples, solve " << n;
    EXPECT_NEAR(plan.stats.effective_sample_size / expected.stats.effective_sample_size, 1, 1e-2);
    EXPECT_NEAR(plan.stats.collided_share, expected.stats.collided_share, 1e-2);
    x = plan.states[1];
  }
}

}  // namespace

template <class P>
std::span<const Image> images() {
  static const Image all[] = {code, code};
  return all;
}

namespace {

/// Compares both methods; many samples are drawn by the threads that roll them out.
template <class P>
void compare_methods(const P& problem, const typename P::template State<double>& start, int horizon,
                     const PerInput& low, const PerInput& high) {
  MppiOptions mppi{.horizon = horizon, .samples = 500, .temperature = 1, .input_min = low, .input_max = high};
  compare(problem, mppi, start, 3);
  mppi.horizon = 21, mppi.samples = 32800;
  if (can_fuse<P>) compare(problem, mppi, start, 1);
  SvgMppiOptions svg = slalom::testing::closed_form(1);
  svg.seed = 1;  // with 0, rounding decides whether a sample of the arm touches the ball
  svg.horizon = horizon;
  svg.samples = 500;
  svg.input_min = low;
  svg.input_max = high;
  svg.variance = svg.variance_max = svg.guides.variance = svg.guides.restart_variance = 0;  // by the bounds
  svg.variance_min = svg.guides.gradient_variance = svg.guides.step = 0;
  compare(problem, svg, start, 1);
}

TEST(GpuEmulation, AllProblems) {
  compare_methods(Pendulum{}, {std::numbers::pi, 0}, 60, -5, 5);
  compare_methods(CartPole{}, {0, 0, std::numbers::pi, 0}, 60, -10, 10);
  compare_methods(DifferentialDrive{}, {0, 0, 0}, 25, {0, -2}, {1.5, 2});
  compare_methods(Quadrotor{}, {0, 0, 0, 0, 0, 0}, 40, {-6, -20}, {6, 20});
  compare_methods(Car{}, {0, 0, 0, 5}, 30, {-0.5, -6}, {0.5, 3});
  compare_methods(PassingPoint{}, {0, 0}, 20, -1, 1);
  Arm::State<double> start;
  std::copy(Arm::start.begin(), Arm::start.end(), start.angle);
  compare_methods(Arm{}, start, 20, -1.5, 1.5);
}
TEST(GpuEmulation, ReadsCopiesOfDeclaredMemoryAsOfTheLastRefresh) {
  compare_methods(WithMemory{}, {1, 0}, 20, -5, 5);
  fake_launch = &emulate<WithMemory>;
  Mppi<WithMemory> controller(WithMemory{}, {.horizon = 20, .samples = 64, .temperature = 1});
  const auto first_input = [&] {
    controller.reset(0);
    return controller.solve({1, 0}).inputs[0][0];
  };
  const double before = first_input();
  controller.problem().weights[2] = 300;
  EXPECT_EQ(first_input(), before);
  controller.refresh();
  EXPECT_NE(first_input(), before);
  controller.problem().weights.assign(1000, 1);  // elsewhere
  EXPECT_EQ(controller.solve({1, 0}).status, Status::degenerate);
}

/// The error that making a controller throws, or "accepted".
template <class P = Pendulum, class Options>
std::string refusal(const Options& options, const P& problem = {}) {
  return message_of<std::exception>([&] { GpuController<P, Options>(problem, options); });
}

/// A driver that works, until a test says otherwise.
class GpuErrors : public ::testing::Test {
 protected:
  GpuErrors() {
    fake_query = fake_allocation = fake_images = 0;
    fake_launch = &emulate<Pendulum>;
  }
  const MppiOptions options_{.horizon = 10, .samples = 64, .temperature = 1};
};

TEST_F(GpuErrors, NameOptionsThatAGpuLacks) {
  EXPECT_EQ(refusal(options_), "accepted");
  EXPECT_EQ(refusal(MppiOptions{}), "mppi.temperature: 0 must be above 0 on a GPU");
  EXPECT_EQ(refusal(MppiOptions{.temperature = 1, .noise = {.knots = 4}}),
            "mppi.noise_knots: 4 must be 0 on a GPU");
  EXPECT_EQ(refusal(MppiOptions{.temperature = 1, .control_cost_discount = 0}),
            "mppi.control_cost_discount: 0 must be 1 on a GPU");
  EXPECT_EQ(refusal(MppiOptions{.horizon = 5000, .temperature = 1}),
            "mppi.horizon: 5000 steps of 1 inputs do not fit into 64 KiB of a GPU's shared memory");
}

TEST_F(GpuErrors, NameADeviceThatLacksCodeOrMemory) {
  fake_images = 1;  // the second image is for this device
  EXPECT_EQ(refusal(options_), "accepted");
  fake_images = 2;
  EXPECT_EQ(refusal(options_), "GPU: loading the problem's code: fake failure");
  fake_images = 0, fake_allocation = 2;
  EXPECT_EQ(refusal(options_), "GPU: memory: fake failure");
}

TEST_F(GpuErrors, NameMemoryThatIsNotDeclaredAndOtherCosts) {
  fake_launch = &emulate<WithMemory>;
  WithMemory problem;
  problem.other = problem.weights.data();
  EXPECT_NE(refusal(options_, problem).find("points to memory of the host at byte"), std::string::npos);
  fake_launch = &ignore;
  EXPECT_NE(refusal(options_).find("samples have other costs than on the processor"), std::string::npos);
}

TEST_F(GpuErrors, ASolveEndsWithItsDeadlineAndWhenTheDeviceIsLost) {
  Mppi<Pendulum> controller(Pendulum{}, options_);
  const auto plan = controller.solve({1, 0}, {});
  EXPECT_EQ(plan.status, Status::ok);
  const double first = plan.inputs[0][0];
  fake_query = 600;
  EXPECT_EQ(controller.solve({1, 0}, {.deadline = 0.01}).status, Status::deadline);
  EXPECT_EQ(controller.fault(), "");
  fake_query = 700;
  EXPECT_EQ(controller.solve({1, 0}, {}).status, Status::degenerate);
  EXPECT_EQ(controller.solve({1, 0}, {}).inputs[0][0], first);
  EXPECT_EQ(controller.fault(), "GPU: kernel: fake failure");
}

TEST_F(GpuErrors, NothingWaitsForADeviceThatNeverEnds) {
  const auto start = std::chrono::steady_clock::now();
  {
    Mppi<Pendulum> controller(Pendulum{}, options_);
    fake_query = 600;
    controller.reset(1);
    EXPECT_EQ(controller.fault(), "GPU: kernel: fake failure");
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 10);
}

}  // namespace
}  // namespace slalom::gpu
