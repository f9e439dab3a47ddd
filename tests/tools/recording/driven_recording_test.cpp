// Recorded drives, and bags of rosbag2: which messages and topics are used, samples, and what is refused.

#include <sqlite3.h>

#include "slalom/core/error.hpp"
#include "slalom/vehicle/model/identification.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"
#include "tools/recording/driven_recording.hpp"
#include "tools/recording/ros_bag.hpp"
#include "view/recording/mcap_writer.hpp"
#include "view/recording/replay.hpp"

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

/// Writes a message in CDR.
class CdrWriter {
 public:
  template <class T>
  CdrWriter& put(T value) {
    bytes_.resize(4 + (bytes_.size() - 4 + sizeof value - 1) / sizeof value * sizeof value, '\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  CdrWriter& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + 1));
    bytes_ += value + '\0';
    return *this;
  }
  CdrWriter& zeros(int count) {
    for (int i = 0; i < count; ++i) put(0.0);
    return *this;
  }
  CdrWriter& header(double time, const std::string& frame) {
    const double second = std::floor(time);
    put(static_cast<std::int32_t>(second))
        .put(static_cast<std::uint32_t>(std::lround(1e9 * (time - second))));
    return text(frame);
  }
  CdrWriter& pose(double x, double y, double yaw) {
    put(x).put(y).zeros(3);
    return put(std::sin(0.5 * yaw)).put(std::cos(0.5 * yaw));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_{"\0\1\0\0", 4};
};

std::string odometry(double time, const std::string& frame, double x, double y, double yaw, double speed) {
  return CdrWriter()
      .header(time, frame)
      .text("base_link")
      .pose(x, y, yaw)
      .zeros(36)
      .put(speed)
      .zeros(41)
      .bytes();
}
std::string drive(double time, double steer) {
  CdrWriter message;
  message.header(time, "").put(static_cast<float>(steer)).put(0.0f).put(2.5f).put(0.0f).put(0.0f);
  return message.bytes();
}

std::string scan(double time, int beams) {
  CdrWriter message;
  message.header(time, "laser");
  for (const float each : {-2.0f, 2.0f, 4.0f / static_cast<float>(beams - 1), 0.0f, 0.025f, 0.1f, 30.0f})
    message.put(each);
  message.put(static_cast<std::uint32_t>(beams));
  for (int i = 0; i < beams; ++i) message.put(1 + 0.01f * static_cast<float>(i));
  return message.put(std::uint32_t{0}).bytes();  // no intensities
}

struct Message {
  std::string topic, type;
  double time = 0;  ///< s
  std::string data;
};

constexpr const char* odometry_type = "nav_msgs/msg/Odometry";
constexpr const char* drive_type = "ackermann_msgs/msg/AckermannDriveStamped";
constexpr double start = 1700000000;  // s

/// A minute of driving with a steering gain of 0.9, in the topics that a car with f1tenth_system has.
std::vector<Message> drive_of_a_minute() {
  std::vector<Message> all;
  double x = 0, y = 0, yaw = 0;
  for (int i = 0; i < 2400; ++i) {
    const double time = start + 0.025 * i, steer = 0.3 * std::sin(0.05 * i), speed = 2;
    all.push_back({"/pf/pose/odom", odometry_type, time + 0.01, odometry(time, "map", x, y, yaw, 0)});
    all.push_back({"/odom", odometry_type, time, odometry(time - 0.005, "odom", 9, 9, 9, speed)});
    all.push_back({"/drive", drive_type, time + 0.01, drive(time + 0.01, steer)});
    all.push_back({"/scan", "sensor_msgs/msg/LaserScan", time, scan(time, 1081)});
    x += 0.025 * speed * std::cos(yaw);
    y += 0.025 * speed * std::sin(yaw);
    yaw += 0.025 * speed * std::tan(0.9 * steer) / 0.33;
  }
  return all;
}

std::uint64_t nanoseconds(double time) {
  return static_cast<std::uint64_t>(std::llround(1e9 * time));
}

void write_mcap(const std::vector<Message>& messages, const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary);
  view::mcap::Writer writer(stream, "test", 1 << 16);
  std::map<std::string, std::uint16_t> channels;
  for (const Message& each : messages) {
    if (!channels.contains(each.topic))
      channels[each.topic] =
          writer.add_channel(each.topic, "cdr", writer.add_schema(each.type, "ros2msg", ""));
    writer.add_message(channels[each.topic], nanoseconds(each.time), each.data);
  }
  writer.finish();
}

void write_sqlite(const std::vector<Message>& messages, const std::filesystem::path& file) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto run = [&](const char* text) {
    ASSERT_EQ(sqlite3_exec(database, text, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL); BEGIN");
  std::map<std::string, int> topics;
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", -1,
                     &insert, nullptr);
  for (const Message& each : messages) {
    int& topic = topics[each.topic];
    if (topic == 0) {
      topic = static_cast<int>(topics.size());
      run(("INSERT INTO topics VALUES (" + std::to_string(topic) + ", '" + each.topic + "', '" + each.type +
           "', 'cdr', '')")
              .c_str());
    }
    sqlite3_bind_int(insert, 1, topic);
    sqlite3_bind_int64(insert, 2, static_cast<std::int64_t>(nanoseconds(each.time)));
    sqlite3_bind_blob(insert, 3, each.data.data(), static_cast<int>(each.data.size()), SQLITE_STATIC);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  run("COMMIT");
  sqlite3_close(database);
}

class RosBag : public testing::TemporaryFolder {
 protected:
  static void expect_the_drive(const std::string& recording) {
    const DrivenRecording drive = read_drive(recording);
    const auto& samples = drive.samples;
    EXPECT_EQ(drive.topics, "poses of /pf/pose/odom, speeds of /odom, commands of /drive");
    ASSERT_EQ(samples.size(), 2400u);
    EXPECT_NEAR(samples[1].time, 0.025, 1e-6);
    EXPECT_NEAR(samples[2].steer_command, 0.3 * std::sin(0.1), 1e-6) << "the command that followed";
    EXPECT_NEAR(samples[2].speed, 2, 1e-12);
    EXPECT_TRUE(std::isnan(samples.back().speed)) << "after the last measured speed";
    const vehicle::Identification found = vehicle::identify(samples, {.wheelbase = 0.33});
    EXPECT_NEAR(found.steering_gain.value, 0.9, 0.01);
    EXPECT_GT(found.explained, 0.99);
  }
};

TEST_F(RosBag, IsReadFromMcapAndSqliteAsFileAndAsFolder) {
  const auto messages = drive_of_a_minute();
  write_mcap(messages, folder_ / "first_0.mcap");
  expect_the_drive((folder_ / "first_0.mcap").string());
  std::filesystem::create_directory(folder_ / "first");
  const std::vector<Message> beginning(messages.begin(), messages.begin() + 4001),
      end(messages.begin() + 4001, messages.end());
  write_sqlite(beginning, folder_ / "first/first_0.db3");
  write_sqlite(end, folder_ / "first/first_1.db3");
  expect_the_drive((folder_ / "first").string());
}

TEST_F(RosBag, OneThatWasCutIsReadUpToTheLastWholeChunk) {
  write_mcap(drive_of_a_minute(), folder_ / "cut.mcap");
  std::filesystem::resize_file(folder_ / "cut.mcap", std::filesystem::file_size(folder_ / "cut.mcap") / 2);
  const std::size_t read = read_drive((folder_ / "cut.mcap").string()).samples.size();
  EXPECT_GT(read, 600u);
  EXPECT_LT(read, 1800u);
}

TEST_F(RosBag, CommandsOfTheMultiplexerAreThoseThatTheCarGot) {
  auto messages = drive_of_a_minute();
  for (int i = 0; i < 2400; ++i)
    messages.push_back(
        {"/ackermann_cmd", drive_type, start + 0.025 * i, drive(start + 0.025 * i + 0.001, 0.25)});
  RosDrive bag;
  for (const Message& each : messages) bag.add(each.topic, each.type, nanoseconds(each.time), each.data);
  const DrivenRecording drive = bag.drive();
  EXPECT_EQ(drive.samples[7].steer_command, 0.25);
  EXPECT_NE(drive.topics.find("commands of /ackermann_cmd"), std::string::npos) << drive.topics;
}

TEST_F(RosBag, HasTheScansOnTheClockOfThePoses) {
  write_mcap(drive_of_a_minute(), folder_ / "first.mcap");
  const std::string file = (folder_ / "first.mcap").string();
  EXPECT_TRUE(read_drive(file).scans.empty());
  const DrivenRecording drive = read_drive(file, Wanted::scans);
  EXPECT_NE(drive.topics.find("scans of /scan"), std::string::npos) << drive.topics;
  ASSERT_EQ(drive.scans.size(), 2400u);
  EXPECT_NEAR(drive.scans[7].time, drive.samples[7].time, 1e-6);
  const maps::LaserScanView view = drive.scans[7].view();
  ASSERT_EQ(view.ranges.size(), 1081u);
  EXPECT_EQ(view.ranges[100], 2.0f);
  EXPECT_EQ(view.angle_min, -2);
  EXPECT_NEAR(view.angle_increment, 4.0 / 1080, 1e-9);
  EXPECT_EQ(view.range_max, 30);
  EXPECT_EQ(drive.samples[7].speed_command, 2.5);
  EXPECT_TRUE(drive.in_map);
}

TEST_F(RosBag, WithoutALocaliserHasThePosesOfOdometry) {
  std::vector<Message> messages = drive_of_a_minute();
  std::erase_if(messages, [](const Message& each) { return each.topic == "/pf/pose/odom"; });
  write_mcap(messages, folder_ / "first.mcap");
  const std::string file = (folder_ / "first.mcap").string();
  const DrivenRecording drive = read_drive(file, Wanted::scans);
  EXPECT_FALSE(drive.in_map);
  ASSERT_EQ(drive.samples.size(), 2400u);
  EXPECT_EQ(drive.samples[5].x, 9);
  std::erase_if(messages, [](const Message& each) { return each.topic == "/scan"; });
  write_mcap(messages, folder_ / "first.mcap");
  expect_error_with<IoError>({"the bag has no scans (sensor_msgs/LaserScan); its topics: "},
                             [&] { read_drive(file, Wanted::scans); });
}

TEST_F(RosBag, ErrorsSayWhatIsMissingAndWhatIsThere) {
  std::vector<Message> messages = drive_of_a_minute();
  std::erase_if(messages, [](const Message& each) { return each.topic == "/pf/pose/odom"; });
  write_mcap(messages, folder_ / "odd.mcap");
  const std::string file = (folder_ / "odd.mcap").string();
  expect_error_with<IoError>({"odd.mcap: the bag has no poses in the frame map",
                              "/odom (odometry in another frame)", "/drive (steering commands)"},
                             [&] { read_drive(file); });
  expect_error_with<IoError>({"odd.mcap: contains nothing to replay", "a bag does not"},
                             [&] { view::load_replay(file); });
  write_mcap({{"/drive", drive_type, start, std::string("\0\1\0\0\7", 5)}}, folder_ / "odd.mcap");
  expect_error_with<IoError>({"odd.mcap: has a message that cannot be read: /drive: it ends too soon"},
                             [&] { read_drive(file); });
  std::ofstream(folder_ / "odd.mcap") << "SQLite format 3";
  expect_error_with<IoError>({"odd.mcap: is not a bag of rosbag2"}, [&] { read_drive(file); });
  std::filesystem::create_directory(folder_ / "empty");
  expect_error_with<IoError>({"empty: is a folder without files of rosbag2 (.mcap, .db3)"},
                             [&] { read_drive((folder_ / "empty").string()); });
}

}  // namespace
}  // namespace slalom::tools
