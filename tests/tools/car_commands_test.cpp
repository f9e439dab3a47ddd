// `slalom identify` finds the servo and the tyres of a simulated car, and `slalom bench` measures models with
// two inputs.
// `slalom explain`: figures of the paper, and mistakes named in words.
// `slalom navigate`: results in JSON, a picture; bad options are refused.
// `slalom replay` and `slalom export`: videos and pages of recordings, and planners beside the driver of one.
#include <cstdlib>
#include <set>

#include "slalom/solvers/registry.hpp"
#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

class BenchCommand : public testing::ProgramTest {};

TEST_F(BenchCommand, MeasuresModelsWithTwoInputs) {
  for (const std::string config : {"default", "default_speed"}) {
    succeed("bench --config " + config +
            " --methods svg_mppi --set svg_mppi.samples=256 --seconds 0.01 --json b.json");
    const json told = result("b.json");
    EXPECT_GT(told["rollout_ns_per_step"], 0) << config;
    EXPECT_GT(told["methods"]["svg_mppi"]["solve_ms"]["p50"], 0) << config;
    EXPECT_GT(told["tick_ms"], told["tick"]["without_solve_ms"]["p50"]) << config;
    ASSERT_EQ(told["vehicle_models"].size(), 4u);
    EXPECT_EQ(told["vehicle_models"][0]["times_the_first"], 1);
    EXPECT_EQ(told["vehicle_models"][3]["model"], "single_track, saturating tyres");
    EXPECT_GT(told["vehicle_models"][3]["rollout_ns_per_step"], 0);
  }
}

class IdentifyCommand : public testing::ProgramTest {};

TEST_F(IdentifyCommand, FindsTheServoOfASimulatedCar) {
  succeed(
      "drive --course eel --config default_kinematic --method mppi --set samples=128 --hardware "
      "--record lap.mcap");
  succeed("identify lap.mcap --wheelbase 0.3302 --json found.json");
  const json found = result("found.json");
  EXPECT_NEAR(found["steering_gain"]["value"], 0.95, 0.05);
  EXPECT_NEAR(found["steering_offset"]["value"], 0.01, 0.004);
  EXPECT_NEAR(found["time_constant"]["value"], 0.07, 0.025);
  EXPECT_NEAR(found["delay"]["value"], 0.045, 0.015);
  EXPECT_GT(found["explained"], 0.9);
  EXPECT_EQ(found["wheelbase"]["deviation"], 0);

  const std::string free = succeed("identify lap.mcap --json free.json");
  testing::expect_says(free, {"determines only the ratio of gain and wheelbase"});
  EXPECT_FALSE(contains(free, "front_length")) << free;
  const json sought = result("free.json");
  const double ratio =
      sought["steering_gain"]["value"].get<double>() / sought["wheelbase"]["value"].get<double>();
  EXPECT_NEAR(ratio, 0.95 / 0.3302, 0.15);
}

TEST_F(IdentifyCommand, FindsTheFrictionOfASimulatedCarWhoseTyresSlip) {
  succeed(
      "drive --course fox --set samples=256 --set world.saturating_tyres=true --set world.friction=0.6 "
      "--laps 2 --record lap.mcap");
  const std::string said = succeed("identify lap.mcap --tyres --config default --json found.json");
  const json found = result("found.json");
  EXPECT_NEAR(found["friction"]["value"], 0.6, 0.06);
  EXPECT_NEAR(found["cornering_front"]["value"], 4.718, 0.9);
  EXPECT_NEAR(found["cornering_rear"]["value"], 5.4562, 1.1);
  EXPECT_NEAR(found["steering_gain"]["value"], 1, 0.08);
  EXPECT_NEAR(found["delay"]["value"], 0.02, 0.01);
  testing::expect_says(said, {"  friction: "});
  expect_refused("identify lap.mcap --config default", {"--config", "--tyres"});
  expect_refused("identify lap.mcap --tyres --wheelbase 0.33", {"--wheelbase", "--tyres"});
  expect_refused("identify lap.mcap --tyres --config nothing", {"nothing", "known: "});
}

TEST_F(IdentifyCommand, RejectsInvalidInput) {
  expect_refused("identify nothing.mcap", {"nothing.mcap", "cannot be read"});
  expect_refused("identify .", {".: is a folder without files of rosbag2"});
  std::ofstream(folder_ / "a.mcap") << "\x89MCAP0\r\n";
  expect_refused("identify a.mcap", {"a.mcap: the bag has no poses"});
  std::ofstream(folder_ / "empty.csv") << "time,x,y\n";
  expect_refused("identify empty.csv", {"empty.csv: is neither a recording in MCAP nor a bag of rosbag2"});
}

class ExplainCommand : public testing::ProgramTest {};

TEST_F(ExplainCommand, DrawsFiguresOfThePaper) {
  const testing::Run python =
      testing::run_shell("PYTHONPATH=$(dirname '" SLALOM_PROGRAM
                         "')/../adapters/python /usr/bin/python3 -c 'import slalom, matplotlib'",
                         folder_.string());
  if (python.status != 0) GTEST_SKIP() << "the Python package or matplotlib is missing: " << python.output;
  std::set<std::string> pictures;
  for (const std::string figure : {"1", "3", "4"}) {
    succeed("explain --figure " + figure + " --plot f" + figure + ".svg");
    pictures.insert(testing::content(folder_ / ("f" + figure + ".svg")));
  }
  EXPECT_EQ(pictures.size(), 3u);
  for (const std::string& picture : pictures) EXPECT_EQ(picture.rfind("<?xml", 0), 0u);
}

TEST_F(ExplainCommand, NamesMistakes) {
  expect_refused("explain --figure 2 --plot f.svg", {"'2' must be 1, 3 or 4"}, 2);
  expect_refused("explain --figure 3", {"--plot: is required"}, 2);
  const std::string words =
      "cp '" SLALOM_PROGRAM "' . && PYTHONPATH= ./slalom explain --figure 3 --plot f.svg";
  const std::string alone = testing::run_shell(words, folder_.string()).output;
  EXPECT_NE(alone.find(" needs the package slalom; SLALOM_PYTHON names another"), std::string::npos) << alone;
}

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

class ExportCommand : public testing::ProgramTest {
 protected:
  void SetUp() override { std::filesystem::create_symlink(testing::recorded_lap(), folder_ / "lap.mcap"); }

  /// The pixels of a video, three bytes each.
  std::string pixels(const std::string& video) const {
    run_shell("ffmpeg -loglevel error -i " + video + " -f rawvideo -pix_fmt rgb24 all.raw", folder_.string());
    return content(folder_ / "all.raw");
  }
};

/// The number of pixels that are nearly of a colour.
int count(std::string_view pixels, int red, int green, int blue) {
  const auto is_near = [&](std::size_t at, int value) {
    return std::abs(static_cast<unsigned char>(pixels[at]) - value) < 12;
  };
  int found = 0;
  for (std::size_t i = 0; i + 2 < pixels.size(); i += 3)
    found += is_near(i, red) && is_near(i + 1, green) && is_near(i + 2, blue);
  return found;
}

TEST_F(ExportCommand, FilmsASpanOfARecording) {
  if (run_shell("command -v ffmpeg").status != 0) GTEST_SKIP() << "ffmpeg is not installed";
  constexpr std::size_t picture = 960 * 540 * 3;  // bytes
  for (const std::string name : {"span.gif", "span.webm"}) {
    expect_says(succeed("export lap.mcap " + name + " --from 2 --to 2.2 --speed 0.5"),
                {"10 pictures, 0.4 s"});
    const std::string all = pixels(name);
    ASSERT_EQ(all.size(), 10 * picture) << name;
    const std::string_view first = std::string_view(all).substr(0, picture);
    EXPECT_NE(first, std::string_view(all).substr(9 * picture)) << "the car drives";
    EXPECT_GT(count(first, 0, 122, 61), 100) << name << ": the plan";
    EXPECT_GT(count(first, 255, 255, 255), 10000) << name << ": the road";
    std::filesystem::remove(folder_ / "all.raw");
  }
}

TEST_F(ExportCommand, WritesAPageThatNeedsNothingElse) {
  expect_says(succeed("export lap.mcap lap.html"), {"page: lap.html"});
  const std::string page = content(folder_ / "lap.html");
  EXPECT_TRUE(testing::contains(page, "<script type=\"application/x-slalom-replay\">"));
  EXPECT_FALSE(testing::contains(page, "src=\"http"));
}

TEST_F(ExportCommand, RefusesWhatItCannotWrite) {
  const auto run = run_shell("PATH=/nowhere '" SLALOM_PROGRAM "' export lap.mcap lap.webm", folder_.string());
  EXPECT_EQ(run.status, 1);
  expect_says(run.output, {"lap.webm: cannot be written: the program ffmpeg is not installed"});
  expect_refused("export lap.mcap lap.avi",
                 {"file: 'lap.avi' must end with .html, .gif, .webm, .mp4 or .webp"}, 2);
  expect_refused("export lap.mcap lap.gif --from 2 --to 1", {"--to: must be larger than --from"}, 2);
  expect_refused("export lap.mcap lap.gif --from 999", {"--from: must be before the recording ends"});
  expect_refused("export lap.mcap lap.html --speed 2", {"--from, --to, --speed: are for videos"}, 2);
  expect_refused("export lap.mcap nowhere/lap.gif", {"nowhere/lap.gif: cannot be written: No such file"}, 1);
  expect_refused("export lap.mcap lap.mcap", {"recording, file", "both name the file lap.mcap"}, 2);
}

using ReplayAgainst = testing::ProgramTest;

TEST_F(ReplayAgainst, ComparesAPlannerWithTheDriver) {
  const std::string lap = testing::recorded_lap().string();
  const auto compared = [&](const std::string& more) {
    succeed("replay " + lap + " --against default --course wren --json all.json " + more);
    return result("all.json");
  };
  // The same planner: the plans differ by their random numbers alone.
  const auto same = compared("--plot plans.png");
  EXPECT_GT(same["moments"].size(), 300u);
  EXPECT_EQ(same["status"]["ok"], same["moments"].size());
  EXPECT_LT(same["steering_rad"]["median"].get<double>(), 0.02);
  EXPECT_LT(same["speed_m_s"]["median"].get<double>(), 0.05);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "plans.png"));
  const auto slow = compared("--set planner.max_speed=1");
  EXPECT_GT(slow["speed_m_s"]["median"].get<double>(), 1.5);

  expect_refused("replay " + lap + " --against default", {"--against", "--course"}, 2);
  expect_refused("replay " + lap + " --against default --course wren --port 0", {"--port", "--against"}, 2);
  expect_refused("replay " + lap + " --against nothing --course wren", {"--config: ", "nothing"});
  for (const std::string option : {"--plot a.png", "--method mppi", "--course wren", "--set a=b"})
    expect_refused("replay " + lap + " " + option, {option.substr(0, option.find(' ')) + ": needs --against"},
                   2);
  expect_refused("replay " + testing::small_recording().string() + " --against default --course wren",
                 {"lap.mcap: has only some of the scans; record the drive with --record-all"});
}

}  // namespace

}  // namespace slalom::tools
