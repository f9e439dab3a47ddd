#include "solvers/solver_contract.hpp"

#include <chrono>
#include <thread>

#include "slalom/problems/quadrotor.hpp"
#include "support/allocation_failures.hpp"
#include "support/allocations.hpp"

namespace slalom {
namespace {

using namespace testing;

class SolverRuntimeContract : public SolverContract {};

TEST_P(SolverRuntimeContract, SameBitsForAnyNumberOfThreads) {
  const std::vector<float> proposals(2 * 12, 0.5f);
  std::vector<float> expected;
  for (const int threads : {1, 2, 7, 16}) {
    const auto solver = make(1, [threads](SolverOptions& o) {
      set(o, "horizon", 12);
      set(o, "samples", *o.find<int>("samples") > 600 ? 3000 : 520);
      set(o, "input_min", -2);
      set(o, "input_max", 2);
      set(o, "threads", threads);
    });
    ProblemEvaluator evaluator(DoubleIntegrator{});
    std::vector<float> seen;
    for (int i = 0; i < 4; ++i) {
      evaluator.set_state({1.0 - 0.1 * i, 0.3});
      const auto& result = solver->solve(evaluator, {.elapsed = 0.025, .proposals = {proposals, i % 3}});
      seen.insert(seen.end(), result.inputs.begin(), result.inputs.end());
      seen.insert(seen.end(), result.weights.begin(), result.weights.end());
      seen.insert(seen.end(), result.variances.begin(), result.variances.end());
    }
    if (threads == 1) expected = seen;
    EXPECT_EQ(seen, expected) << threads << " threads";
  }
}

TEST_P(SolverRuntimeContract, ResetRepeatsAndSeedsDiffer) {
  const auto solver = make(1, small);
  ProblemEvaluator evaluator(DoubleIntegrator{});
  evaluator.set_state({0.4, 0});
  const auto run = [&](std::uint64_t seed) {
    solver->reset(seed);
    std::vector<float> seen;
    for (int i = 0; i < 3; ++i) {
      const auto& result = solver->solve(evaluator, {.elapsed = 0.03});
      seen.insert(seen.end(), result.inputs.begin(), result.inputs.end());
    }
    return seen;
  };
  const auto first = run(5), other = run(6), again = run(5);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
}

TEST_P(SolverRuntimeContract, ACopyGoesOnWithTheSameBits) {
  const std::vector<float> proposals(2 * 10, 0.5f);
  ProblemEvaluator evaluator(DoubleIntegrator{});
  const auto solve = [&](Solver& solver, int i) {
    evaluator.set_state({0.4 - 0.05 * i, 0.1});
    solver.solve(evaluator, {.elapsed = 0.03, .proposals = {proposals, i % 3}});
  };
  const auto bits = [](const Solver& solver) {
    const SolveResult& r = solver.result();
    std::vector<float> all;
    for (const auto& part :
         {r.inputs, r.nominal, r.mean, r.variances, r.costs, r.weights, r.guides.values, r.guide_path.values})
      all.insert(all.end(), part.begin(), part.end());
    for (int row = 0; r.samples && row < r.samples->rows(); ++row)
      all.insert(all.end(), (*r.samples)[row].begin(), (*r.samples)[row].end());
    all.push_back(static_cast<float>(r.suspicious_solves));
    return all;
  };
  auto original = make(1, small);
  EXPECT_EQ(bits(*original->clone()), bits(*original));
  for (int i = 0; i < 3; ++i) solve(*original, i);
  if (GetParam().name.size() % 2 == 0) original->prepare();
  const auto copy = original->clone();
  EXPECT_EQ(bits(*copy), bits(*original));
  std::vector<std::vector<float>> expected;
  for (int i = 3; i < 6; ++i) {
    solve(*original, i);
    expected.push_back(bits(*original));
  }
  original.reset();  // the copy does not need it
  for (int i = 3; i < 6; ++i) {
    solve(*copy, i);
    EXPECT_EQ(bits(*copy), expected[i - 3]) << i;
  }
}

TEST_P(SolverRuntimeContract, PreparedNoiseChangesNothing) {
  const auto plain = make(1, small), prepared = make(1, small);
  ProblemEvaluator evaluator(DoubleIntegrator{});
  evaluator.set_state({0.4, 0});
  for (int i = 0; i < 3; ++i) {
    prepared->prepare();
    const auto a = plain->solve(evaluator, {}).inputs, b = prepared->solve(evaluator, {}).inputs;
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin()));
  }
}

TEST_P(SolverRuntimeContract, SolvingAllocatesNothing) {
  for (const int threads : {1, 3}) {
    const auto solver = make(2, [threads](SolverOptions& o) {
      small(o);
      set(o, "threads", threads);
    });
    const auto evaluator = simple(2, [](float a, float b, int k) { return k % 5 ? a + b : std::nan(""); });
    const auto broken = simple(2, [](float, float, int) { return std::nan(""); });
    const std::vector<float> proposals(2 * 2 * 10, 0.5f);  // two sequences of two inputs
    const long before = testing::allocations();
    for (int i = 0; i < 3; ++i) {
      solver->prepare();
      solver->solve(evaluator, {.elapsed = 0.03, .proposals = {proposals, 2}});
      solver->solve(broken, {.elapsed = 0.03, .deadline = 1});
      solver->reset(static_cast<std::uint64_t>(i));
    }
    EXPECT_EQ(testing::allocations(), before) << threads << " threads";
  }
}

TEST(Controller, SolvingAllocatesNothing) {
  for (const char* method : solver_names()) {
    SolverOptions options = solver_options(method);
    small(options);
    Controller controller{problems::Quadrotor{}, options};
    problems::Quadrotor::State<double> lost{};
    lost.x = std::nan("");
    const long before = testing::allocations();
    for (int i = 0; i < 3; ++i) {
      controller.prepare();
      controller.solve({}, {.elapsed = 0.03});
      controller.solve(lost, {.elapsed = 0.03, .deadline = 1});
      controller.set_previous_input({});
      controller.reset(static_cast<std::uint64_t>(i));
    }
    EXPECT_EQ(testing::allocations(), before) << method;
  }
}

TEST_P(SolverRuntimeContract, DeadlineReturnsTheBestSoFar) {
  const auto solver = make(1, [](SolverOptions& o) {
    set(o, "horizon", 10);
    set(o, "input_min", -2);
    set(o, "input_max", 1);
  });
  const auto quick = simple(1, [](float a, float b, int) { return a + b; });
  for (int i = 0; i < 2; ++i) solver->solve(quick, {});
  // No time is left: nothing is evaluated, the last plan comes back.
  const auto& result = solver->solve(quick, {.deadline = 0});
  EXPECT_EQ(result.status, Status::deadline);
  expect_usable(result, 10, -2, 1);
  // Each sample takes long, so the deadline falls into the solve.
  const auto slow = simple(1, [](float a, float b, int k) {
    if (k % 64 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
    return a + b;
  });
  const auto start = std::chrono::steady_clock::now();
  const auto& late = solver->solve(slow, {.deadline = 0.001});
  EXPECT_EQ(late.status, Status::deadline);
  expect_usable(late, 10, -2, 1);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 2.0);
  EXPECT_EQ(solver->solve(quick, {.deadline = 60}).status, Status::ok);
}

/// An evaluator that wants all samples in one call, which takes 20 ms.
class SlowBatches final : public BatchEvaluator {
 public:
  int inputs() const noexcept override { return 1; }
  bool whole_batches() const noexcept override { return true; }
  void evaluate(const SequenceBatch&, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    for (int k = first; k < first + count; ++k) costs[k] = static_cast<float>(k), collided[k] = 0;
  }
};

TEST_P(SolverRuntimeContract, ASolveThatIsLateSaysSo) {
  const auto solver = make(1, [](SolverOptions& o) { set(o, "horizon", 3); });
  EXPECT_EQ(solver->solve(SlowBatches{}, {.deadline = 0.005}).status, Status::deadline);
}

TEST_P(SolverRuntimeContract, AnInterruptionCostsFewSamplesLater) {
  const auto solver = make(1, [](SolverOptions& o) {
    set(o, "horizon", 3);
    set(o, "samples", *o.find<int>("samples") > 600 ? 20'000 : 2000);
  });
  int pause = 100;  // us for 64 samples
  const auto slow = simple(1, [&](float a, float b, int k) {
    if (k % 64 == 0) std::this_thread::sleep_for(std::chrono::microseconds(std::exchange(pause, 100)));
    return a + b;
  });
  const auto most_rollouts = [&](int solves) {
    int most = 0;
    for (int i = 0; i < solves; ++i) most = std::max(most, solver->solve(slow, {.deadline = 8e-3}).rollouts);
    return most;
  };
  const int before = most_rollouts(9);
  int after = 0;  // of up to three interruptions, since other programs interrupt solves, too
  for (int i = 0; i < 3 && 2 * after <= before; ++i) pause = 50'000, after = most_rollouts(12);
  EXPECT_GT(2 * after, before);
}

TEST_P(SolverRuntimeContract, WarmStartFollowsTheClock) {
  const auto solver = make(1, [](SolverOptions& o) {
    small(o);
    set_if_any(o, "control_cost_discount", 1);
    set(o, "shift_warm_start", true);
    set(o, "zero_mean_share", 0);
    set(o, "variance", 0.2);
  });
  // Wants u[t] = 0.1 t at first; broken costs then show the fallback, which is the shifted solution.
  const auto ramp = sum_over_steps([](double u, int t) { return 100 * std::pow(u - 0.1 * t, 2); });
  for (int i = 0; i < 10; ++i) solver->solve(ramp, {});
  const auto last = solver->solve(ramp, {}).inputs;
  const std::vector<float> before(last.begin(), last.end());
  const auto broken = simple(1, [](float, float, int) { return std::nan(""); });
  const auto shifted = solver->solve(broken, {.elapsed = 0.075}).inputs;  // a step and a half
  if (GetParam().name.starts_with("reverse_mppi") || GetParam().name == "cem_send_best" ||
      GetParam().name == "icem") {
    GTEST_SKIP() << "starts from another sequence than the one it sends";
  }
  for (std::size_t t = 0; t + 2 < before.size(); ++t)
    EXPECT_NEAR(shifted[t], 0.5f * (before[t + 1] + before[t + 2]), 1e-5f) << t;
  EXPECT_NEAR(shifted[9], before[9], 1e-6f);
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverRuntimeContract, ::testing::ValuesIn(option_sets()),
                         [](const auto& set) { return set.param.name; });

/// The published program does not clamp what its particles send.
TEST(SvMpc, OnlyTheUnclampedSolutionLeavesTheBounds) {
  const auto furthest = [](bool clamp) {
    SolverOptions options = published_options("sv_mpc");
    set(options, "clamp_solution", clamp);
    const auto solver = make_solver(options, 1);
    EXPECT_EQ(solver->keeps_bounds(), clamp);
    const auto evaluator = FunctionEvaluator(1, [](const SequenceBatch& batch, int k) {
      return std::pair(-100.0 * static_cast<double>(batch.at(0, 0, k)), false);
    });
    float most = 0;
    for (int i = 0; i < 20; ++i)
      for (const float u : solver->solve(evaluator, {}).inputs) {
        EXPECT_TRUE(std::isfinite(u));
        most = std::max(most, std::abs(u));
      }
    return most;
  };
  EXPECT_LE(furthest(true), 0.45f);
  EXPECT_GT(furthest(false), 0.45f);
}

// Memory may run out at any allocation of a construction: std::bad_alloc, and nothing is lost.

SolverOptions few_samples(SolverOptions options) {
  small(options);
  set(options, "samples", 40);
  return options;
}

TEST(AllocationFailure, EverySolverIsMadeOrThrows) {
  for (const OptionSet& each : option_sets())
    for (const int threads : {1, 3}) {
      SolverOptions options = few_samples(each.options);
      set(options, "threads", threads);
      SCOPED_TRACE(each.name + ", threads " + std::to_string(threads));
      EXPECT_GT(fail_every_allocation([&] { return make_solver(options, 2)->inputs(); }), 10);
    }
}

TEST(AllocationFailure, EveryControllerIsMadeOrThrowsAndThenSolves) {
  for (const char* method : solver_names()) {
    SCOPED_TRACE(method);
    const SolverOptions options = few_samples(solver_options(method));
    EXPECT_GT(fail_every_allocation([&] {
                Controller controller{problems::Quadrotor{}, options};
                return controller.solve({}).cost;
              }),
              10);
  }
}

}  // namespace
}  // namespace slalom
