// Bags of ROS 1, with the messages in them.
#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "tools/bags/bag_drive.hpp"
#include "tools/recording/bag_writer.hpp"

namespace slalom::fuzz {
namespace {

using testing::Wire;

Wire laser_scan(double stamp) {
  Wire scan;
  scan.header(stamp, "laser");
  for (const float value : {-1.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.1F, 30.0F}) scan.put(value);
  return scan.put(std::uint32_t{3}).put(1.5F).put(2.0F).put(2.5F).put(std::uint32_t{0});
}

Wire pose_fields(Wire wire, double x, double y) {
  for (const double value : {x, y, 0.0, 0.0, 0.0, 0.0, 1.0}) wire.put(value);
  return wire;
}

Wire odometry(double stamp, double speed) {
  return pose_fields(Wire().header(stamp, "map").text("base"), stamp, 0)
      .zeros(36 * 8)
      .put(speed)
      .zeros(5 * 8)
      .zeros(36 * 8);
}

std::vector<std::string> seeds() {
  testing::BagWriter bag;
  for (const double stamp : {10.0, 10.05, 10.1}) {
    bag.add("/odom", "nav_msgs/Odometry", odometry(stamp - 0.01, 2));
    bag.add("/pf/pose/odom", "nav_msgs/Odometry", odometry(stamp, 0));
    bag.add("/scan", "sensor_msgs/LaserScan", laser_scan(stamp));
    bag.add("/drive", "ackermann_msgs/AckermannDriveStamped",
            Wire().header(stamp + 0.01, "").put(0.1F).zeros(4).put(2.0F).zeros(8));
  }
  const std::string without_map = bag.bytes();
  testing::BagWriter extras;
  extras.add("/map", "nav_msgs/OccupancyGrid",
             pose_fields(Wire().header(0, "map").zeros(8).put(0.1F).put(2).put(2), -1, -1)
                 .put(std::uint32_t{4})
                 .put(0x00640000));
  extras.add("/tf_static", "tf2_msgs/TFMessage",
             pose_fields(Wire().put(std::uint32_t{1}).header(0, "base").text("laser"), 0.2, 0));
  extras.add("/reference_waypoint", "waypoint_msg/Waypoint",
             pose_fields(Wire().header(0, "map").put(std::uint32_t{1}).header(0, "map"), 1, 2)
                 .put(std::uint32_t{1})
                 .header(0, "map")
                 .put(3.0)
                 .zeros(40));
  return {without_map, extras.bytes() + without_map.substr(13)};
}

bool run(std::string_view bytes) {
  try {
    const tools::BagDrive drive = tools::load_bag_drive(scratch_file("drive.bag", bytes));
    for (const tools::BagTick& tick : drive.ticks) require(!tick.ranges.empty(), "a tick has its scan");
    if (drive.map) {
      const auto cells =
          static_cast<std::size_t>(drive.map->width) * static_cast<std::size_t>(drive.map->height);
      require(drive.map->cells.size() == cells, "a map has its cells");
      require(drive.map->resolution > 0 && std::isfinite(drive.map->resolution), "a map has a resolution");
    }
    return true;
  } catch (const IoError&) {
    return false;
  }
}

const Target target("bag", 8192, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
