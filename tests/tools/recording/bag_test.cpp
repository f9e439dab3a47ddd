// Bags of ROS 1: reading them, and the errors for damaged ones.
#include "tools/bags/bag_drive.hpp"

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "tools/bags/ros_bag.hpp"
#include "tools/recording/bag_writer.hpp"

namespace slalom::tools {
namespace {

using testing::BagWriter;
using testing::Wire;

class Bag : public testing::TemporaryFolder {
 protected:
  std::string load(const std::string& bytes) const {
    try {
      load_bag_drive(write("a.bag", bytes).string());
    } catch (const IoError& error) {
      return error.what();
    }
    return "loaded";
  }
  void expect_error(const std::string& bytes, const std::vector<std::string>& words) const {
    const std::string message = load(bytes);
    for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
  }
};

TEST_F(Bag, HandsOverMessagesInOrder) {
  BagWriter bag;
  bag.add("/a", "std_msgs/A", Wire().put(1));
  bag.add("/b", "std_msgs/B", Wire().text("two"));
  bag.add("/a", "std_msgs/A", Wire().put(3));
  std::vector<std::string> seen;
  read_bag(write("a.bag", bag.bytes()).string(), [&](const BagMessage& message) {
    seen.push_back(message.topic + " " + message.type + " " + std::to_string(message.data.size()));
  });
  EXPECT_EQ(seen, (std::vector<std::string>{"/a std_msgs/A 4", "/b std_msgs/B 7", "/a std_msgs/A 4"}));
  EXPECT_TRUE(is_bag("drive.bag"));
  EXPECT_FALSE(is_bag("drive.mcap"));
}

TEST_F(Bag, RejectsFilesThatAreNotReadable) {
  EXPECT_THROW(load_bag_drive((folder_ / "nothing.bag").string()), IoError);
  expect_error("no bag at all", {"a.bag", "is not a ROS 1 bag"});
  BagWriter bag;
  bag.add("/a", "std_msgs/A", Wire().zeros(1000));
  const std::string good = bag.bytes();
  expect_error(good.substr(0, good.size() / 2), {"a.bag", "incomplete", "rosbag reindex"});
  expect_error(BagWriter().bytes("lz4"), {"a.bag", "lz4", "rosbag decompress"});
}

/// Every chunk holds the next, up to a depth that exceeds any stack.
TEST_F(Bag, RejectsChunksWithinChunks) {
  const std::string header = Wire().text("op=\x05").text("compression=none").bytes();
  const int depth = 100000;
  const std::size_t each = 8 + header.size();
  std::string bytes = "#ROSBAG V2.0\n";
  for (int i = 1; i <= depth; ++i)
    bytes += Wire()
                 .text(header)
                 .put(static_cast<std::uint32_t>(each * static_cast<std::size_t>(depth - i)))
                 .bytes();
  expect_error(bytes, {"a.bag", "a chunk is within a chunk"});
}

TEST_F(Bag, RejectsMissingTopicsAndWrongMessages) {
  expect_error(BagWriter().bytes(), {"a.bag", "/scan"});
  BagWriter other;
  other.add("/scan", "sensor_msgs/PointCloud2", Wire());
  expect_error(other.bytes(), {"/scan", "sensor_msgs/PointCloud2", "sensor_msgs/LaserScan"});
  BagWriter torn;
  torn.add("/drive", "ackermann_msgs/AckermannDriveStamped", Wire().put(1));
  expect_error(torn.bytes(), {"/drive", "is incomplete"});
}

}  // namespace
}  // namespace slalom::tools
