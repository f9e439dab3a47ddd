// Memory that runs out at any allocation of a construction: std::bad_alloc, and nothing is lost.
#include <gtest/gtest.h>

#include "slalom/problems/quadrotor.hpp"
#include "slalom/slalom.hpp"
#include "solvers/set_option.hpp"
#include "solvers/solver_contract.hpp"
#include "support/allocation_failures.hpp"

namespace slalom {
namespace {

SolverOptions few_samples(SolverOptions options) {
  testing::small(options);
  testing::set(options, "samples", 40);
  return options;
}

TEST(AllocationFailure, EverySolverIsMadeOrThrows) {
  for (const testing::OptionSet& set : testing::option_sets())
    for (const int threads : {1, 3}) {
      SolverOptions options = few_samples(set.options);
      testing::set(options, "threads", threads);
      SCOPED_TRACE(set.name + ", threads " + std::to_string(threads));
      EXPECT_GT(testing::fail_every_allocation([&] { return make_solver(options, 2)->inputs(); }), 10);
    }
}

TEST(AllocationFailure, EveryControllerIsMadeOrThrowsAndThenSolves) {
  for (const char* method : solver_names()) {
    SCOPED_TRACE(method);
    const SolverOptions options = few_samples(solver_options(method));
    EXPECT_GT(testing::fail_every_allocation([&] {
                Controller controller{problems::Quadrotor{}, options};
                return controller.solve({}).cost;
              }),
              10);
  }
}

}  // namespace
}  // namespace slalom
