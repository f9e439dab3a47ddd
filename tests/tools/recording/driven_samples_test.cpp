// The readers of driven laps: what a line must be, and how long it may be.
#include "tools/recording/driven_recording.hpp"

#include <cmath>
#include <fstream>

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::tools {
namespace {

class DrivenSamples : public testing::TemporaryFolder {
 protected:
  std::string written(const std::string& text) const {
    std::ofstream(folder_ / "lap.jsonl") << text;
    return (folder_ / "lap.jsonl").string();
  }
  /// The error message for a recording with this text.
  std::string refusal(const std::string& text) const {
    try {
      read_driven_samples(written(text));
    } catch (const IoError& error) {
      return error.what();
    }
    return "nothing";
  }
};

const std::string header = "{\"type\": \"recording\"}\n";
const std::string tick = R"({"type": "tick", "time": 0.5, "odometry": [1, 2, null, 3], "command": [0.1, 4]})";

TEST_F(DrivenSamples, AreTheTicksOfARecording) {
  const auto samples = read_driven_samples(written(header + tick + "\n{\"type\": \"lap\"}\n" + tick));
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].time, 0.5);
  EXPECT_EQ(samples[1].x, 1);
  EXPECT_TRUE(std::isnan(samples[1].yaw));
  EXPECT_EQ(samples[1].steer_command, 0.1);
}

TEST_F(DrivenSamples, ALineOfMoreThanFourMebibytesIsRefused) {
  const std::string longest = "{\"type\": \"note\", \"text\": \"" + std::string((1 << 22) - 28, 'x') + "\"}";
  ASSERT_EQ(longest.size(), std::size_t{1} << 22);
  EXPECT_EQ(read_driven_samples(written(header + longest + "\n" + tick)).size(), 1u);
  EXPECT_NE(refusal(header + longest + " \n" + tick).find("lap.jsonl:2: is longer than 4194304 bytes"),
            std::string::npos)
      << refusal(header + longest + " \n" + tick);
}

TEST_F(DrivenSamples, ARecordingOfMoreThanFourGibibytesIsRefused) {
  const std::string file = written(header + tick + "\n");
  std::filesystem::resize_file(file, (std::uintmax_t{1} << 32) + 1);  // zeros that take no place on the disk
  expect_error_with<IoError>({"lap.jsonl: has 4294967297 bytes; at most 4294967296 are read"},
                             [&] { read_driven_samples(file); });
}

TEST_F(DrivenSamples, OneThatWasCutNamesTheRepair) {
  const std::string cut = header + tick + "\n" + tick.substr(0, 40);
  EXPECT_NE(refusal(cut).find("lap.jsonl:3: the recording was cut in this line; remove it"),
            std::string::npos)
      << refusal(cut);
}

TEST_F(DrivenSamples, ErrorsNameTheLine) {
  EXPECT_NE(refusal(header + tick + "\n{\"type\": \"tick\"}\n").find("lap.jsonl:3: must be a record"),
            std::string::npos);
  EXPECT_NE(refusal("hello").find("lap.jsonl:1: must be a record"), std::string::npos);
  EXPECT_NE(refusal(tick).find("lap.jsonl:1: must be the first line of a recording"), std::string::npos);
}

}  // namespace
}  // namespace slalom::tools
