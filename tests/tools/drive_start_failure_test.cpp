// Memory that runs out at any allocation of what `slalom drive` does before its first lap: an error,
// and nothing is lost.
#include <gtest/gtest.h>

#include "support/allocation_failures.hpp"
#include "tools/scenario/scenario.hpp"

namespace slalom::tools {
namespace {

TEST(DriveStart, LoadsItsScenarioOrThrows) {
  ScenarioArguments arguments;
  arguments.course = SLALOM_COURSES "/wren";
  arguments.config = SLALOM_CONFIGS "/default.yaml";
  arguments.set = {"samples=32", "vehicle.max_speed=3", "world.friction=0.9"};
  EXPECT_GT(testing::fail_every_allocation(
                [&] {
                  const Scenario scenario = load_scenario(arguments, "mppi");
                  return settings_json(arguments, scenario, "mppi").dump();
                },
                100),
            1000);
}

}  // namespace
}  // namespace slalom::tools
