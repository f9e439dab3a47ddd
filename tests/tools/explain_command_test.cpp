// `slalom explain`: a picture and figures of every method, and mistakes named in words.
#include <set>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

using nlohmann::json;

class ExplainCommand : public testing::ProgramTest {};

TEST_F(ExplainCommand, ShowsEveryMethodInPictureAndFigures) {
  succeed("explain --method all --seed 3 --plot all.png --json all.json");
  EXPECT_EQ(testing::content(folder_ / "all.png").rfind("\x89PNG\r\n\x1a\n", 0), 0u);
  const json told = result("all.json");
  ASSERT_EQ(told["methods"].size(), 9u);
  for (const json& method : told["methods"]) {
    EXPECT_EQ(method["inputs"].size(), 20u) << method["method"];
    EXPECT_EQ(method["plan"].size(), 21u);
    double weights = 0, area = 0;
    for (const json& sample : method["samples"]) weights += sample["weight"].get<double>();
    EXPECT_NEAR(weights, 1, 1e-3) << method["method"];
    const auto& places = method["optimal"]["place"];
    for (const json& d : method["optimal"]["density"])
      area += d.get<double>() * (places[1].get<double>() - places[0].get<double>());
    EXPECT_NEAR(area, 1, 1e-6);
    const bool guided = method["method"].get<std::string>().rfind("svg_mppi", 0) == 0;
    EXPECT_EQ(method["guide_ways"].size(), guided ? 4u : 0u);
    if (guided) {
      EXPECT_EQ(method["guide_ways"][0].size(), 10u * 10u);
    }
  }
}

TEST_F(ExplainCommand, SetsOptionsOfMethodsAndProblem) {
  const auto inputs = [&](const std::string& more) {
    return json::parse(succeed("explain --method mppi --solves 1 --json - " + more))["methods"][0];
  };
  EXPECT_NE(inputs("")["inputs"], inputs("--set temperature=5")["inputs"]);
  EXPECT_EQ(inputs("--set samples=64")["samples"].size(), 64u);
  // Without a disc there is one way, straight on.
  EXPECT_FALSE(inputs("--set problem.disc_radius=0")["collided"].get<bool>());
}

TEST_F(ExplainCommand, SaysWhatIsWrong) {
  testing::expect_says(succeed("explain --method mppi --set temperature=1e-6 --json cold.json"),
                       {"few_samples: the effective sample size is below 3"});
  EXPECT_EQ(result("cold.json")["methods"][0]["symptom"], "few_samples");
  succeed("explain --method mppi,svg_mppi --json good.json");
  const json good = result("good.json");
  for (const json& method : good["methods"]) EXPECT_EQ(method["symptom"], "none") << method["method"];
}

TEST_F(ExplainCommand, DrawsFiguresOfThePaper) {
  std::set<std::string> pictures;
  for (const std::string figure : {"1", "3", "4"}) {
    succeed("explain --figure " + figure + " --plot f" + figure + ".svg");
    pictures.insert(testing::content(folder_ / ("f" + figure + ".svg")));
  }
  EXPECT_EQ(pictures.size(), 3u);
  EXPECT_FALSE(pictures.contains(""));
}

TEST_F(ExplainCommand, NamesMistakes) {
  expect_refused("explain --method newton", {"must be one of all, mppi"});
  expect_refused("explain --figure 2 --plot f.svg", {"must be 1, 3 or 4"});
  expect_refused("explain --figure 3", {"needs --plot"});
  expect_refused("explain --set temprature=2", {"did you mean temperature?"});
  expect_refused("explain --set samples=0", {"must be in"});
  expect_refused("explain --set problem.radius=1", {"problem."});
  expect_refused("explain --set samples", {"key=value"});
}

}  // namespace
}  // namespace slalom::tools
