// `slalom explain`: a picture and figures of every method, and mistakes named in words.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "tools/program.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::run_program;

TEST(ExplainCommand, ShowsEveryMethodInPictureAndFigures) {
  const testing::ScopedFolder scoped;
  const fs::path& folder = scoped.path();
  const auto run =
      run_program("explain --method all --seed 3 --plot all.png --json all.json", folder.string());
  ASSERT_EQ(run.status, 0) << run.output;
  const json told = json::parse(std::ifstream(folder / "all.json"));
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
  std::ifstream picture(folder / "all.png", std::ios::binary);
  std::string signature(8, '\0');
  picture.read(signature.data(), 8);
  EXPECT_EQ(signature, "\x89PNG\r\n\x1a\n");
}

TEST(ExplainCommand, SetsOptionsOfMethodsAndProblem) {
  const auto inputs = [](const std::string& more) {
    const auto run = run_program("explain --method mppi --solves 1 --json - " + more);
    EXPECT_EQ(run.status, 0) << run.output;
    return json::parse(run.output)["methods"][0];
  };
  EXPECT_NE(inputs("")["inputs"], inputs("--set temperature=5")["inputs"]);
  EXPECT_EQ(inputs("--set samples=64")["samples"].size(), 64u);
  // Without a disc there is one way, straight on.
  EXPECT_FALSE(inputs("--set problem.disc_radius=0")["collided"].get<bool>());
}

TEST(ExplainCommand, NamesMistakes) {
  const auto refusal = [](const std::string& arguments) {
    const auto run = run_program("explain " + arguments);
    EXPECT_NE(run.status, 0) << arguments;
    return run.output;
  };
  EXPECT_NE(refusal("--method newton").find("must be one of all, mppi"), std::string::npos);
  EXPECT_NE(refusal("--set temprature=2").find("did you mean temperature?"), std::string::npos);
  EXPECT_NE(refusal("--set samples=0").find("must be in"), std::string::npos);
  EXPECT_NE(refusal("--set problem.radius=1").find("problem."), std::string::npos);
  EXPECT_NE(refusal("--set samples").find("key=value"), std::string::npos);
}

}  // namespace
}  // namespace slalom::tools
