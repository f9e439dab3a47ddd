/// Plans of a controller are finite, within the bounds and within the rates, whatever enters it.
#if defined(__linux__)
#endif
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "slalom/slalom.hpp"
#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The double integrator with a limit of its input's rate.
struct RateLimited : testing::DoubleIntegrator {
  double input_rate_max = 0.5;  // 1/s
};

const RateLimited::State<double> at_rest{1, 0};

/// Checks a plan of one input against its bounds and its rate; `previous` was applied before it.
template <class Plan>
void expect_valid(const Plan& plan, double low, double high, double reach, double previous) {
  for (const auto& u : plan.inputs) {
    ASSERT_TRUE(std::isfinite(u[0]));
    EXPECT_GE(u[0], low);
    EXPECT_LE(u[0], high);
    EXPECT_LE(std::abs(u[0] - previous), reach * (1 + 1e-12));
    previous = u[0];
  }
  EXPECT_TRUE(std::isfinite(plan.cost));
  for (const CostTerm& term : plan.cost_terms) EXPECT_TRUE(std::isfinite(term.value)) << term.name;
  for (const auto& x : plan.states) EXPECT_TRUE(std::isfinite(x.position) && std::isfinite(x.speed));
}

TEST(FinalCheck, ARateLimitStartsFromWithinTheBounds) {
  Mppi controller{RateLimited{}, {.horizon = 10, .samples = 64, .input_min = 0.5, .input_max = 1}};
  expect_valid(controller.solve(at_rest), 0.5, 1, 0.05, 0.5);
}

TEST(FinalCheck, APreviousInputOutsideTheBoundsIsMovedIntoThem) {
  Mppi controller{RateLimited{}, {.horizon = 10, .samples = 64, .input_min = 0.5, .input_max = 1}};
  controller.set_previous_input({{5}});
  expect_valid(controller.solve(at_rest), 0.5, 1, 0.05, 1);
  controller.set_previous_input({{-infinite}});
  const auto plan = controller.solve(at_rest);
  expect_valid(plan, 0.5, 1, 1, plan.inputs[0][0]);
}

TEST(FinalCheck, IgnoresAPreviousInputThatIsNotANumber) {
  Mppi controller{RateLimited{}, {.horizon = 10, .samples = 64, .input_min = 0.5, .input_max = 1}};
  const double before = controller.solve(at_rest).inputs[0][0];
  controller.set_previous_input({{not_a_number}});
  const auto plan = controller.solve(at_rest);
  expect_valid(plan, 0.5, 1, 0.05, before);
  EXPECT_GT(plan.corrections, 0);
  EXPECT_EQ(controller.solve(at_rest).corrections, 0);
}

TEST(FinalCheck, TheAnswerBeforeTheFirstSolveIsWithinTheBounds) {
  Mppi controller{RateLimited{}, {.horizon = 4, .samples = 64, .input_min = 0.5, .input_max = 1}};
  const auto plan = controller.solve({not_a_number, 0});
  EXPECT_EQ(plan.status, Status::non_finite_state);
  expect_valid(plan, 0.5, 1, 0, 0.5);
  controller.solve(at_rest);
  controller.reset(1);
  expect_valid(controller.solve({not_a_number, 0}), 0.5, 1, 0, 0.5);
}

TEST(FinalCheck, ASolverOfOnesOwnIsHeldWithinTheProblemsBounds) {
  struct Bounded : testing::DoubleIntegrator {
    double input_min = -1, input_max = 1;
  };
  Controller controller{Bounded{},
                        make_solver(MppiOptions{.samples = 64, .input_min = 3, .input_max = 4}, 1)};
  const auto plan = controller.solve({1, 0});
  expect_valid(plan, -1, 1, 2, plan.inputs[0][0]);
  EXPECT_EQ(plan.corrections, 30);
}

TEST(FinalCheck, ACostThatIsNotFiniteIsNotOk) {
  Mppi controller{testing::DoubleIntegrator{},
                  {.horizon = 8, .samples = 64, .input_min = -1, .input_max = 1}};
  for (const double far : {1e30, 1e200, 1.7e308}) {
    const auto plan = controller.solve({far, far});
    EXPECT_EQ(plan.status, Status::degenerate) << far;
    expect_valid(plan, -1, 1, 2, plan.inputs[0][0]);
  }
  EXPECT_EQ(controller.solve(at_rest).status, Status::ok);
}

TEST(FinalCheck, AParameterThatChangesToNonsenseStopsTheInputs) {
  Mppi controller{RateLimited{}, {.horizon = 8, .samples = 64, .input_min = -1, .input_max = 1}};
  const double before = controller.solve(at_rest).inputs[0][0];
  for (const double rate : {not_a_number, -1.0, -infinite}) {
    controller.problem().input_rate_max = rate;
    controller.set_previous_input({{before}});
    expect_valid(controller.solve(at_rest), -1, 1, 0, before);
  }
}

TEST(FinalCheck, RejectsBoundsThatNoInputCanKeep) {
  const auto error = [](double low, double high) {
    return message_of([&] { Mppi(testing::DoubleIntegrator{}, {.input_min = low, .input_max = high}); });
  };
  for (const double far : {1e13, 1e30, 1e300}) {
    EXPECT_NE(error(-far, 1).find("input_min: "), std::string::npos) << far;
    EXPECT_NE(error(-1, far).find("input_max: "), std::string::npos) << far;
  }
  EXPECT_NE(error(not_a_number, 1), "accepted");
  EXPECT_NE(error(infinite, infinite), "accepted");
  EXPECT_NE(error(-infinite, -infinite), "accepted");
  EXPECT_EQ(error(-infinite, infinite), "accepted");
  EXPECT_EQ(error(0.5, 0.5), "accepted");  // equal bounds are legal
  EXPECT_EQ(error(-1e12, 1e12), "accepted");
}

TEST(FinalCheck, WhatAProblemSaysOfItsInputsIsValidated) {
  struct Bounded : testing::DoubleIntegrator {
    double input_min = -1, input_max = 1, input_rate_max = 1;
  };
  const auto error = [&](const Bounded& problem) {
    return message_of([&] { Mppi controller(problem, {}); });
  };
  EXPECT_EQ(error({}), "accepted");
  EXPECT_NE(error({{}, not_a_number, 1, 1}).find("problem.input_min: nan"), std::string::npos);
  EXPECT_NE(error({{}, -1, not_a_number, 1}).find("problem.input_max: nan"), std::string::npos);
  EXPECT_NE(error({{}, 2, 1, 1}).find("input_min: 2 must be at most input_max, 1"), std::string::npos);
  EXPECT_NE(error({{}, -1, 1, not_a_number}).find("problem.input_rate_max: nan"), std::string::npos);
  EXPECT_NE(error({{}, -1, 1, -2}).find("problem.input_rate_max: -2"), std::string::npos);
  EXPECT_EQ(error({{}, -1, 1, 0}), "accepted");
  EXPECT_NE(error({{.dt = not_a_number}, -1, 1, 1}).find("problem: duration of a step"), std::string::npos);
  EXPECT_NE(error({{.dt = -0.1}, -1, 1, 1}).find("problem: duration of a step"), std::string::npos);
}

using testing::DoubleIntegrator;

class SystemCalls : public ::testing::TestWithParam<const char*> {};

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
constexpr int not_possible = 77;

/// From here on the kernel kills this process at any system call but exit. (The strict mode that needs no
/// filter would forbid the processor's clock as well, which is read without a system call.)
bool forbid_system_calls() {
  sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, 0),  // the call's number
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
  };
  const sock_fprog program{4, filter};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// Solves in a process that may not call the system.
[[noreturn]] void solve_without_system_calls(Solver& solver, const BatchEvaluator& evaluator) {
  const SolveRequest request{.elapsed = 0.02, .deadline = 10};
  solver.solve(evaluator, request);  // chooses the instruction set and touches every page
  if (!forbid_system_calls()) _exit(not_possible);
  for (int i = 0; i < 5; ++i) {
    solver.prepare();
    solver.solve(evaluator, request);
  }
  syscall(SYS_exit, 0);
  __builtin_unreachable();
}

TEST_P(SystemCalls, SolvingOnOneThreadMakesNone) {
  ProblemEvaluator<DoubleIntegrator> evaluator{DoubleIntegrator{}};
  evaluator.set_state({1, 0});
  SolverOptions options = solver_options(GetParam());
  *options.find<int>("samples") = 256;
  const auto solver = make_solver(options, 1);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) solve_without_system_calls(*solver, evaluator);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == not_possible)
    GTEST_SKIP() << "this system does not let a process forbid itself system calls";
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "wait status " << status;
}
#else
TEST_P(SystemCalls, SolvingOnOneThreadMakesNone) {
  GTEST_SKIP() << "needs Linux, and a build without sanitizers";
}
#endif

INSTANTIATE_TEST_SUITE_P(Solvers, SystemCalls,
                         ::testing::ValuesIn(solver_names().begin(), solver_names().end()),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace

}  // namespace slalom
