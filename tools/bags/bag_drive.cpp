#include "tools/bags/bag_drive.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "slalom/core/error.hpp"
#include "tools/bags/ros_bag.hpp"
#include "tools/bags/ros_messages.hpp"

namespace slalom::tools {
namespace {

constexpr double max_gap = 0.2;  // s between two poses, and from a measured speed to its use

struct Topics {
  std::vector<ros::Scan> scans;
  std::vector<ros::Odometry> poses, odometry;
  std::vector<ros::Drive> commands;
  std::vector<ros::Transform> transforms;
  std::set<std::string> names;
};

/// Takes a message in if it is one that is wanted.
void take(const BagMessage& message, Topics& topics, BagDrive& drive) {
  const auto is = [&](const char* topic, const char* type) {
    if (message.topic != topic) return false;
    if (message.type != type) throw std::invalid_argument("is of type " + message.type + ", not " + type);
    return true;
  };
  topics.names.insert(message.topic);
  if (is("/scan", "sensor_msgs/LaserScan")) topics.scans.push_back(ros::scan(message.data));
  if (is("/pf/pose/odom", "nav_msgs/Odometry")) topics.poses.push_back(ros::odometry(message.data));
  if (is("/odom", "nav_msgs/Odometry")) topics.odometry.push_back(ros::odometry(message.data));
  if (is("/drive", "ackermann_msgs/AckermannDriveStamped"))
    topics.commands.push_back(ros::drive(message.data));
  if (is("/map", "nav_msgs/OccupancyGrid")) drive.map = ros::map(message.data);
  if (is("/tf_static", "tf2_msgs/TFMessage"))
    for (const ros::Transform& each : ros::transforms(message.data)) topics.transforms.push_back(each);
  if (is("/reference_waypoint", "waypoint_msg/Waypoint")) {
    drive.path.clear();
    for (const ros::Waypoint& point : ros::waypoints(message.data))
      drive.path.push_back({point.pose.x, point.pose.y, point.pose.yaw, point.speed, 0});
  }
}

template <class Messages>
void sort(Messages& messages) {
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.header.stamp < b.header.stamp; });
}

/// The first message that is later than `stamp`.
template <class Messages>
auto after(const Messages& messages, double stamp) {
  return std::upper_bound(messages.begin(), messages.end(), stamp,
                          [](double s, const auto& m) { return s < m.header.stamp; });
}

/// The pose at `stamp`, between the two next to it; none where they are too far apart.
std::optional<maps::Pose> pose_at(const std::vector<ros::Odometry>& poses, double stamp) {
  constexpr double same = 1e-6;  // s; stamps are whole nanoseconds
  const auto next = after(poses, stamp + same);
  if (next == poses.begin()) return {};
  const ros::Odometry& before = *std::prev(next);
  if (stamp - before.header.stamp <= same) return before.pose;
  if (next == poses.end() || next->header.stamp - before.header.stamp > max_gap) return {};
  const double share = (stamp - before.header.stamp) / (next->header.stamp - before.header.stamp);
  const maps::Pose &a = before.pose, &b = next->pose;
  return maps::Pose{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
                    a.yaw + share * maps::wrap_angle(b.yaw - a.yaw)};
}

void join(Topics& topics, BagDrive& drive) {
  const double begin = topics.scans.front().header.stamp;
  for (ros::Scan& scan : topics.scans) {
    const double stamp = scan.header.stamp;
    const auto pose = pose_at(topics.poses, stamp);
    const auto speed = after(topics.odometry, stamp);
    // The driver's command for this scan, or its last command if there is none.
    auto command = after(topics.commands, stamp);
    if (command == topics.commands.end() && command != topics.commands.begin()) --command;
    if (!pose || speed == topics.odometry.begin() || command == topics.commands.end() ||
        stamp - std::prev(speed)->header.stamp > max_gap ||
        std::abs(command->header.stamp - stamp) > max_gap) {
      ++drive.left_out;
      continue;
    }
    drive.ticks.push_back({stamp - begin,
                           scan.shape,
                           std::move(scan.ranges),
                           {*pose, std::prev(speed)->speed},
                           {command->steer, command->speed}});
  }
}

std::string list(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "nothing" : text;
}

}  // namespace

BagDrive load_bag_drive(const std::string& file) {
  Topics topics;
  BagDrive drive;
  read_bag(file, [&](const BagMessage& message) {
    try {
      take(message, topics, drive);
    } catch (const std::invalid_argument& error) {
      throw IoError(file, 0, "a message on " + message.topic + " " + error.what());
    }
  });
  for (const char* needed : {"/scan", "/odom", "/drive", "/pf/pose/odom"})
    if (!topics.names.contains(needed))
      throw IoError(file, 0, std::string("has no message on ") + needed + "; it holds " + list(topics.names));
  sort(topics.scans);
  sort(topics.poses);
  sort(topics.odometry);
  sort(topics.commands);
  const std::string laser = topics.scans.front().header.frame;
  for (const ros::Transform& each : topics.transforms)
    if (each.child == laser) drive.laser = each.pose;
  join(topics, drive);
  if (drive.ticks.empty()) throw IoError(file, 0, "contains no scan with a known pose, speed and command");
  return drive;
}

}  // namespace slalom::tools
