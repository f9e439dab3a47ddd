// Memory that runs out at any allocation of what `slalom drive` does before its first lap, and of reading and
// writing JSON: an error, and nothing is lost.
#include <gtest/gtest.h>

#include "slalom/evaluation/json.hpp"
#include "support/allocation_failures.hpp"
#include "tools/scenario/scenario.hpp"

namespace slalom::tools {
namespace {

TEST(AllocationFailure, ADriveStartsOrThrows) {
  ScenarioArguments arguments;
  arguments.course = SLALOM_COURSES "/wren";
  arguments.config = SLALOM_CONFIGS "/default.yaml";
  arguments.set = {"samples=32", "vehicle.max_speed=3", "world.friction=0.9"};
  EXPECT_GT(testing::fail_every_allocation(
                [&] {
                  const Scenario scenario = load_scenario(arguments, "mppi");
                  return settings_json(arguments, scenario, "mppi").dump();
                },
                2000),
            1000);
}

TEST(AllocationFailure, JsonIsReadAndWrittenOrThrows) {
  std::string text = R"({"nested":{"empty":[],"none":{}},"list":[1,-2,0.5,true,null)";
  for (int i = 0; i < 40; ++i)
    text += ",[\"a text that no short string holds\",{\"key " + std::to_string(i) + "\":0}]";
  text += "]}";
  EXPECT_EQ(Json::parse(text).dump(), text);
  EXPECT_GT(testing::fail_every_allocation([&] { return Json::parse(text).dump(2); }), 200);
}

}  // namespace
}  // namespace slalom::tools
