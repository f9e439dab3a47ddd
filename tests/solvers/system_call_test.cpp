#include <gtest/gtest.h>

#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"

#if defined(__linux__)
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace slalom {
namespace {

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
