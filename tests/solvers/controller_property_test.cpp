#include <gtest/gtest.h>

#include "solvers/controller_calls.hpp"
#include "solvers/solver_contract.hpp"
#include "support/adversarial_tries.hpp"

/// Random and adversarial calls of every method, option set and problem: every plan is valid.
namespace slalom {
namespace {

TEST(ControllerProperty, EveryPlanIsValidForAnyCall) {
  const long calls = testing::repetitions(200000);
  const auto sets = testing::option_sets();
  testing::ControllerTally tally;
  testing::try_adversaries(calls, tally.calls, [&](testing::Adversary& adversary, std::uint64_t seed) {
    const auto& set = sets[seed % sets.size()];
    testing::call_any_controller(set.options, adversary, tally);
  });
  std::printf("[ calls    ] %ld calls, %ld plans: %ld ok, %ld with another status; %ld corrections\n",
              tally.calls, tally.plans, tally.ok, tally.other, tally.corrections);
  EXPECT_GT(tally.ok, 0);
  EXPECT_GT(tally.other, 0);
}

}  // namespace
}  // namespace slalom
