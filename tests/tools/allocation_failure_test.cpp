// Memory that runs out at any allocation of what `slalom drive` does before its first lap, and of reading and
// writing JSON: an error, and nothing is lost. The tests of the evaluation have the start of the lap itself.
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "slalom/evaluation/json.hpp"
#include "support/allocation_failures.hpp"
#include "support/temporary_folder.hpp"
#include "tools/scenario/scenario.hpp"

namespace slalom::tools {
namespace {

/// A number for all values that it was given, so that two drives can be compared without an allocation.
class Digest {
 public:
  void add(double value) { digest_ = 31 * digest_ + std::hash<double>{}(value); }

  template <class Field>
  void add_option(const Field& field) {
    if constexpr (std::is_same_v<Field, PerInput>) {
      for (const double value : field.values()) add(value);
    } else if constexpr (std::is_same_v<Field, Choice>) {
      add(field.index());
    } else {
      add(static_cast<double>(field));
    }
  }
  template <class Options>
  void add_options(const Options& options) {
    visit_options(options, [&](const auto& field, const Declaration&) { add_option(field); });
  }
  void add_configuration(const vehicle::Configuration& configuration) {
    vehicle::visit_sections(configuration, [&](const char*, const auto& options) { add_options(options); });
  }

  std::size_t value() const { return digest_; }

 private:
  std::size_t digest_ = 0;
};

TEST(AllocationFailure, ADriveStartsOrThrows) {
  // A short file: AConfigurationIsLoadedOrThrows has a long one, which would make each of these starts slow.
  const testing::ScopedFolder folder;
  ScenarioArguments arguments;
  arguments.course = SLALOM_COURSES "/wren";
  arguments.config =
      folder.write("short.yaml", "mppi: {samples: 64, variance: [0.05]}\nvehicle:\n  max_speed: 4\n")
          .string();
  arguments.set = {"samples=32", "vehicle.max_speed=3", "world.friction=0.9"};
  EXPECT_GT(testing::fail_every_allocation(
                [&] {
                  Scenario scenario = load_scenario(arguments, "mppi");
                  Digest digest;
                  digest.add_configuration(scenario.configuration);
                  digest.add_options(scenario.lap);
                  for (const maps::ReferencePoint& point : scenario.environment->path)
                    for (const double each : {point.x, point.y, point.yaw, point.speed}) digest.add(each);
                  for (const maps::Occupancy cell : scenario.environment->course.map.cells)
                    digest.add(static_cast<double>(cell));
                  return std::pair(digest.value(), std::move(scenario.notes));
                },
                testing::every_allocation),
            300);
}

TEST(AllocationFailure, AConfigurationIsLoadedOrThrows) {
  ScenarioArguments arguments;
  arguments.config = SLALOM_CONFIGS "/default.yaml";
  arguments.set = {"samples=32", "vehicle.max_speed=3"};
  EXPECT_GT(testing::fail_every_allocation(
                [&] {
                  Digest digest;
                  digest.add_configuration(load_configuration(arguments, "mppi"));
                  return digest.value();
                },
                testing::every_allocation),
            1000);
}

TEST(AllocationFailure, TheSettingsOfADriveAreWrittenOrThrow) {
  ScenarioArguments arguments;
  arguments.course = SLALOM_COURSES "/wren";
  const Scenario scenario = load_scenario(arguments, "mppi");
  EXPECT_GT(testing::fail_every_allocation([&] { return settings_json(arguments, scenario, "mppi").dump(); },
                                           testing::every_allocation),
            300);
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
