// The readers of driven laps: which messages are samples, and what is refused.
#include "tools/recording/driven_recording.hpp"

#include <cmath>
#include <fstream>

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"
#include "view/recording/mcap_writer.hpp"

namespace slalom::tools {
namespace {

class DrivenSamples : public testing::TemporaryFolder {
 protected:
  /// Writes a recording with these messages of the topic /tick and returns its file.
  std::string written(std::initializer_list<const char*> ticks) const {
    std::ofstream stream(folder_ / "lap.mcap", std::ios::binary);
    view::mcap::Writer writer(stream, "slalom");
    const auto channel =
        writer.add_channel("/tick", "json", writer.add_schema("slalom.Tick", "jsonschema", "{}"));
    for (const char* tick : ticks) writer.add_message(channel, 500000000, tick);
    writer.finish();
    return (folder_ / "lap.mcap").string();
  }
};

constexpr const char* tick = R"({"time": 0.5, "odometry_x": 1, "odometry_y": 2, "odometry_yaw": null,
                                 "odometry_speed": 3, "command_steer": 0.1, "command_speed": 3})";

TEST_F(DrivenSamples, AreTheTicksOfARecording) {
  const auto samples = read_drive(written({tick, tick})).samples;
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].time, 0.5);
  EXPECT_EQ(samples[1].x, 1);
  EXPECT_TRUE(std::isnan(samples[1].yaw));
  EXPECT_EQ(samples[1].steer_command, 0.1);
  EXPECT_EQ(samples[1].speed_command, 3);
}

TEST_F(DrivenSamples, ARecordingOfMoreThanFourGibibytesIsRefused) {
  const std::string file = written({tick});
  std::filesystem::resize_file(file, (std::uintmax_t{1} << 32) + 1);  // zeros that take no place on the disk
  expect_error_with<IoError>({"lap.mcap: has 4294967297 bytes; at most 4294967296 are read"},
                             [&] { read_drive(file); });
}

TEST_F(DrivenSamples, ErrorsNameTheFileAndTheTopic) {
  for (const char* wrong : {"[1]", "{", "{\"time\": 0.5}"})
    expect_error_with<IoError>({"lap.mcap: has a message that cannot be read: /tick: "}, [&] {
      read_drive(written({tick, wrong}));
    });
  std::ofstream(folder_ / "lap.mcap") << "hello, this is no recording";
  expect_error_with<IoError>({"lap.mcap: is neither a recording in MCAP nor a bag of rosbag2"},
                             [&] { read_drive((folder_ / "lap.mcap").string()); });
}

}  // namespace
}  // namespace slalom::tools
