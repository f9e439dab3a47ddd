#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "slalom/gpu/memory.hpp"
#include "slalom/gpu/settings.hpp"
#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/passing_point.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"
#include "slalom/slalom.hpp"
#include "solvers/closed_form.hpp"

namespace slalom::gpu {
namespace {

using namespace problems;

/// Solves with the kernels' source, whose blocks run as loops on the host.
template <class P, class Options>
class Emulator {
  static constexpr bool guided = std::is_same_v<Options, SvgMppiOptions>;

 public:
  Emulator(const P& problem, const Options& options, const Shape& shape)
      : settings_(settings_of(options, P::inputs, shape)), time_step_(slalom::detail::time_step_of(problem)) {
    const Settings& s = settings_;
    const auto rows = static_cast<std::size_t>(s.horizon * P::inputs);
    mean_.resize(rows), nominal_.resize(rows), variance_.resize(rows), plan_.resize(rows);
    partial_.resize(static_cast<std::size_t>(s.groups * padded_rows(s.horizon * P::inputs)));
    sums_.resize(static_cast<std::size_t>(s.groups));
    if (guided) theta_.resize(static_cast<std::size_t>(guide_doubles(s, s.horizon * P::inputs)));
    memory_.resize(static_cast<std::size_t>(
        std::max(sample_floats(s, s.horizon * P::inputs), guide_floats_of(s, s.horizon * P::inputs)) / 2 +
        1));
    std::memset(static_cast<void*>(&a_), 0, sizeof a_);
    std::memcpy(a_.problem, static_cast<const void*>(&problem), sizeof problem);
    a_.settings = s;
    a_.buffers = {mean_.data(), nominal_.data(), variance_.data(), theta_.data(), partial_.data(),
                  sums_.data(), nullptr,         nullptr,          plan_.data(),  &report_};
    a_.seed = options.seed;
    reset(a_, memory());
  }

  void solve(const slalom::detail::StateOf<P, double>& x, double elapsed) {
    double values[slalom::detail::state_size<P>];
    std::memcpy(values, &x, sizeof values);
    std::copy_n(values, slalom::detail::state_size<P>, a_.start);
    a_.stream = (solves_ << 16) | (guided ? 1u : 0u);
    a_.shift = Shift::of(time_step_ > 0 ? elapsed / time_step_ : 0, settings_.horizon);
    a_.solve = static_cast<unsigned>(++solves_);
    if constexpr (guided) {
      for (int g = 0; g < settings_.guides; ++g) MovingGuide<P>(a_, g, memory()).run();
      finish_guides(a_, memory());
    }
    for (int group = 0; group < settings_.groups; ++group) solve_group<P, guided>(a_, group, memory());
    combine<P, guided>(a_, memory());
  }

  const std::vector<float>& plan() const { return plan_; }        ///< [step][input]
  const std::vector<float>& nominal() const { return nominal_; }  ///< [step][input]
  const Report& report() const { return report_; }                ///< of the last solve

 private:
  float* memory() { return reinterpret_cast<float*>(memory_.data()); }

  Settings settings_;
  double time_step_;
  unsigned long long solves_ = 0;
  std::vector<float> mean_, nominal_, variance_, plan_, partial_;
  std::vector<double> theta_, memory_;
  std::vector<GroupSums> sums_;
  Report report_{};
  Arguments<P> a_;
};

/// Solves with the processor's solver and with the kernels' source, with the same seed, and compares the
/// plans.
template <class P, class Options>
void compare(const P& problem, const Options& options, typename P::template State<double> x,
             const Shape& shape, int solves) {
  ProblemEvaluator<P> evaluator(problem);
  const auto solver = make_solver(options, P::inputs);
  Emulator<P, Options> emulator(problem, options, shape);
  for (int n = 0; n < solves; ++n) {
    evaluator.set_state(x);
    const SolveResult& result = solver->solve(evaluator, {.elapsed = problem.dt});
    emulator.solve(x, problem.dt);
    double plan = 0, nominal = 0;
    for (std::size_t r = 0; r < result.inputs.size(); ++r) {
      plan = std::max<double>(plan, std::abs(result.inputs[r] - emulator.plan()[r]));
      nominal = std::max<double>(nominal, std::abs(result.nominal[r] - emulator.nominal()[r]));
    }
    EXPECT_LT(plan, 1e-3) << Options::method << ", solve " << n;
    if constexpr (std::is_same_v<Options, SvgMppiOptions>) {
      EXPECT_LT(nominal, 1e-3) << "solve " << n;
    }
    EXPECT_NEAR(emulator.report().effective_samples / result.effective_sample_size, 1, 1e-2);
    EXPECT_NEAR(emulator.report().collided / static_cast<float>(options.samples), result.collided_share,
                1e-2);
    Input<double, P::inputs> u;
    for (int i = 0; i < P::inputs; ++i)
      u[i] = static_cast<double>(result.inputs[static_cast<std::size_t>(i)]);
    x = slalom::detail::step<P, double>(problem, x, slalom::detail::look_up<P, double>(problem, x), u, 0);
  }
}

PerInput squares(std::initializer_list<double> deviation, double factor) {
  std::vector<double> values;
  for (const double d : deviation) values.push_back(factor * d * d);
  return PerInput(values);
}

template <class P>
void compare_methods(const P& problem, const typename P::template State<double>& start, int horizon,
                     std::initializer_list<double> deviation, std::initializer_list<double> low,
                     std::initializer_list<double> high) {
  MppiOptions mppi{.horizon = horizon,
                   .samples = 500,
                   .temperature = 1,
                   .variance = squares(deviation, 1),
                   .input_min = low,
                   .input_max = high,
                   .control_cost_discount = 0};
  compare(problem, mppi, start, {false, 16}, 3);
  if (can_fuse<P::inputs>) compare(problem, mppi, start, {true, 32}, 3);
  SvgMppiOptions svg = slalom::testing::closed_form(1);
  svg.horizon = horizon;
  svg.samples = 500;
  svg.input_min = low;
  svg.input_max = high;
  svg.variance = svg.variance_max = svg.guides.restart_variance = squares(deviation, 1);
  svg.guides.variance = svg.guides.gradient_variance = squares(deviation, 0.5);
  svg.variance_min = svg.guides.step = squares(deviation, 0.25);
  compare(problem, svg, start, {false, 16}, 1);
  if (can_fuse<P::inputs>) compare(problem, svg, start, {true, 32}, 1);
}

TEST(GpuEmulation, Pendulum) {
  compare_methods(Pendulum{}, {std::numbers::pi, 0}, 60, {2}, {-5}, {5});
}
TEST(GpuEmulation, CartPole) {
  compare_methods(CartPole{}, {0, 0, std::numbers::pi, 0}, 60, {3}, {-10}, {10});
}
TEST(GpuEmulation, DifferentialDrive) {
  compare_methods(DifferentialDrive{}, {0, 0, 0}, 25, {0.6, 1.2}, {0, -2}, {1.5, 2});
}
TEST(GpuEmulation, Quadrotor) {
  compare_methods(Quadrotor{}, {0, 0, 0, 0, 0, 0}, 40, {1.4, 2.8}, {-6, -20}, {6, 20});
}
TEST(GpuEmulation, Car) {
  compare_methods(Car{}, {0, 0, 0, 5}, 30, {0.3, 1.4}, {-0.5, -6}, {0.5, 3});
}
TEST(GpuEmulation, PassingPoint) {
  compare_methods(PassingPoint{}, {0, 0}, 20, {0.5}, {-1}, {1});
}
TEST(GpuEmulation, Arm) {
  Arm::State<double> start;
  std::copy(Arm::start.begin(), Arm::start.end(), start.angle);
  compare_methods(Arm{}, start, 20, {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, {-1.5}, {1.5});
}

TEST(GpuSettings, RefusesOptionsThatAGpuLacksByName) {
  const auto refusal = [](auto options) -> std::string {
    try {
      settings_of(options, 2);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(MppiOptions{.samples = 2048, .temperature = 1}), "");
  EXPECT_EQ(refusal(MppiOptions{}), "mppi.temperature: 0 must be above 0 on a GPU");
  EXPECT_EQ(refusal(MppiOptions{.temperature = 1, .noise = {.knots = 4}}),
            "mppi.noise_knots: 4 must be 0 on a GPU");
  EXPECT_EQ(refusal(MppiOptions{.horizon = 5000, .temperature = 1}),
            "mppi.horizon: 5000 steps of 2 inputs do not fit into 64 KiB of a GPU's shared memory");
}

struct WithMemory {
  double before = 1;
  std::vector<float> declared;
  const float* other = nullptr;
  template <class V>
  void visit_memory(V&& visit) const {
    visit(declared);
  }
};

TEST(GpuMemory, IsFoundAndRedirectedAndMustBeDeclared) {
  WithMemory problem{.declared = {1, 2, 3}};
  const std::vector<SharedMemory> memory = memory_of(problem);
  ASSERT_EQ(memory.size(), 1u);
  EXPECT_EQ(memory[0].data, problem.declared.data());
  EXPECT_EQ(memory[0].bytes, 12u);
  alignas(WithMemory) unsigned char copy[sizeof problem];
  std::memcpy(copy, static_cast<const void*>(&problem), sizeof problem);
  EXPECT_EQ(redirect(copy, memory[0], 0x7000), 3);  // begin, end, end of the capacity
  std::uint64_t begin;
  std::memcpy(&begin, copy + offsetof(WithMemory, declared), sizeof begin);
  EXPECT_EQ(begin, 0x7000u);
  problem.other = problem.declared.data();
  EXPECT_THROW(memory_of(problem), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::gpu
