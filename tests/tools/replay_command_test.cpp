// `slalom replay`: videos of recordings, and planners beside the driver of one.
#include <cstdlib>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

using testing::content;
using testing::expect_says;
using testing::run_shell;

class ReplayVideo : public testing::ProgramTest {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    const auto run = program(
        "drive --course wren --obstacles 2 --seed 3 --method mppi --set mppi.samples=200"
        " --record lap.mcap");
    ASSERT_TRUE(std::filesystem::exists(folder_ / "lap.mcap")) << run.output;
  }

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

TEST_F(ReplayVideo, ShowsASpanOfARecording) {
  if (run_shell("command -v ffmpeg").status != 0) GTEST_SKIP() << "ffmpeg is not installed";
  constexpr std::size_t picture = 960 * 540 * 3;  // bytes
  for (const std::string name : {"span.gif", "span.webm"}) {
    expect_says(succeed("replay lap.mcap --video " + name + " --from 2 --to 2.4 --speed 0.5"),
                {"20 pictures, 0.8 s"});
    const std::string all = pixels(name);
    ASSERT_EQ(all.size(), 20 * picture) << name;
    const std::string_view first = std::string_view(all).substr(0, picture);
    EXPECT_NE(first, std::string_view(all).substr(19 * picture)) << "the car drives";
    EXPECT_GT(count(first, 0, 135, 107), 100) << name << ": the plan";
    EXPECT_GT(count(first, 255, 255, 255), 10000) << name << ": the road";
    std::filesystem::remove(folder_ / "all.raw");
  }
}

TEST_F(ReplayVideo, RefusesWhatItCannotWrite) {
  const auto run =
      run_shell("PATH=/nowhere '" SLALOM_PROGRAM "' replay lap.mcap --video lap.webm", folder_.string());
  EXPECT_EQ(run.status, 1);
  expect_says(run.output, {"lap.webm: cannot be written: the program ffmpeg is not installed"});
  expect_refused("replay lap.mcap --video lap.avi", {"--video", "must end with .gif, .webm, .mp4 or .webp"});
  expect_refused("replay lap.mcap --video lap.gif --from 2 --to 1", {"--to: must be larger than --from"});
  expect_refused("replay lap.mcap --video lap.gif --from 999", {"--from: must be before the recording ends"});
  expect_refused("replay lap.mcap --speed 2", {"--speed", "--video"});
  if (run_shell("command -v ffmpeg").status != 0) return;
  expect_refused("replay lap.mcap --video nowhere/lap.gif --to 1",
                 {"nowhere/lap.gif: cannot be written: ffmpeg ended"});
}

using ReplayAgainst = testing::ProgramTest;

TEST_F(ReplayAgainst, ComparesAPlannerWithTheDriver) {
  succeed("drive --course wren --obstacles 2 --seed 3 --record-all --record lap.mcap");
  const auto compared = [&](const std::string& more) {
    succeed("replay lap.mcap --against default --course wren --json all.json " + more);
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

  expect_refused("replay lap.mcap --against default", {"--against", "--course"});
  expect_refused("replay lap.mcap --against default --course wren --video a.gif", {"--video"});
  expect_refused("replay lap.mcap --against nothing --course wren", {"--config: ", "nothing"});
}

TEST_F(ReplayAgainst, NeedsAllScans) {
  succeed("drive --course wren --set mppi.samples=100 --method mppi --record few.mcap");
  expect_refused("replay few.mcap --against default --course wren",
                 {"few.mcap: has only some of the scans; record the drive with --record-all"});
}

}  // namespace
}  // namespace slalom::tools
