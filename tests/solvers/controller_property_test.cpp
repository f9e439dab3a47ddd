#include <gtest/gtest.h>

#include "solvers/controller_calls.hpp"
#include "solvers/solver_contract.hpp"
#include "support/promise.hpp"
#include "support/repetitions.hpp"

/// Random and adversarial calls of every method, option set and problem: every plan is valid.
namespace slalom {
namespace {

TEST(ControllerProperty, EveryPlanIsValidForAnyCall) {
  const long calls = testing::repetitions(200000);
  const auto sets = testing::option_sets();
  testing::ControllerTally tally;
  for (std::uint64_t seed = testing::first_seed(); tally.calls < calls; ++seed) {
    testing::Adversary adversary(seed);
    const auto& set = sets[seed % sets.size()];
    try {
      testing::call_any_controller(set.options, adversary, tally);
    } catch (const testing::Finding& finding) {
      FAIL() << "seed " << seed << ", options " << set.name << ": " << finding.what();
    }
  }
  std::printf("[ calls    ] %ld calls, %ld plans: %ld ok, %ld with another status; %ld corrections\n",
              tally.calls, tally.plans, tally.ok, tally.other, tally.corrections);
  EXPECT_GT(tally.ok, 0);
  EXPECT_GT(tally.other, 0);
}

}  // namespace
}  // namespace slalom
