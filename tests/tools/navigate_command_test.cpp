// `slalom navigate`: results in JSON, a picture; bad options are refused.
#include "slalom/solvers/registry.hpp"
#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

class NavigateCommand : public testing::ProgramTest {};

TEST_F(NavigateCommand, DrivesAScenarioWithBothMethodsOnTheSameSeeds) {
  const std::string said =
      succeed("navigate --scenario no-way --seeds 2 --jobs 2 --json out.json --pictures pictures");
  const auto results = result("out.json");
  ASSERT_EQ(results["results"].size(), 2u);
  for (const auto& row : results["results"]) {
    EXPECT_EQ(row["scenario"], "no-way");
    EXPECT_EQ(row["successes"], 2);
    EXPECT_EQ(row["collisions"], 0);
    EXPECT_LE(row["by_seed"][0]["answer_time_s"], 0.5);
  }
  EXPECT_EQ(results["results"][1]["driver"], "mppi");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures/no-way.png"));
  expect_says(said,
              {"svg_mppi succeeds in 2 of 2 drives (0 collisions),\nmppi in 2 of 2 (0)\n",
               "2 of 2 (34 to 100 %)", "svg_mppi - mppi", "0.000 [0.000, 0.000]", "from its heading, rad"});
  for (std::size_t begin = 0, end = 0; (end = said.find('\n', begin)) != std::string::npos; begin = end + 1)
    EXPECT_LE(end - begin, 100u) << said.substr(begin, end - begin);
}

TEST_F(NavigateCommand, DrivesWithEveryMethod) {
  std::string methods;
  for (const char* name : solver_names()) methods += (methods.empty() ? "" : ",") + std::string(name);
  succeed("navigate --scenario no-way --seeds 1 --jobs 2 --json out.json --methods " + methods);
  const auto results = result("out.json")["results"];
  ASSERT_EQ(results.size(), solver_names().size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i]["driver"], solver_names()[i]);
    EXPECT_EQ(results[i]["successes"], 1) << solver_names()[i];
  }
}

TEST_F(NavigateCommand, RefusesWhatItDoesNotKnow) {
  expect_refused("navigate --scenario kitchen",
                 {"slalom: --scenario: 'kitchen' must be one of close-obstacle, pallet-on-path"});
  expect_refused("navigate --barn /no/such/folder", {"/no/such/folder/world_0.world"});
  expect_refused("navigate --scenario no-way --methods dwa",
                 {"--methods", "'dwa'", "must be one of mppi, svg_mppi"});
  expect_refused("navigate --scenario no-way --methods mppi,svg_mppi,mppi",
                 {"--methods", "mppi", "is given twice"});
  expect_refused("navigate --scenario no-way --json /no/such/folder/out.json",
                 {"out.json", "cannot be written"});
}

}  // namespace
}  // namespace slalom::tools
