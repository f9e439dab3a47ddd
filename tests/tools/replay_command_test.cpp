// `slalom replay` and `slalom export`: videos and pages of recordings, and planners beside the driver of one.
#include <cstdlib>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

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
