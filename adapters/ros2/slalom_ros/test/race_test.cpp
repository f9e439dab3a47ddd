// Laps among parked cars: simulator, localiser and planner, each a process or all composed in one.
// Their messages are recorded and read back.
//
// usage: race_test processes|composed [LAPS [OBSTACLES]]
#include <cmath>

#include <nav_msgs/msg/odometry.hpp>
#include <nav_msgs/msg/path.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <slalom_msgs/msg/planner_metrics.hpp>
#include <std_msgs/msg/int32.hpp>

#include "nodes.hpp"
#include "recording.hpp"

namespace slalom_ros_test {
namespace {

using ackermann_msgs::msg::AckermannDriveStamped;

double seconds(const builtin_interfaces::msg::Time& time) {
  return time.sec + 1e-9 * time.nanosec;
}

void record_all(Recording& recording) {
  const auto latched = rclcpp::QoS(1).transient_local();
  recording.add("scan", "sensor_msgs/msg/LaserScan", rclcpp::SensorDataQoS());
  recording.add("drive", "ackermann_msgs/msg/AckermannDriveStamped", rclcpp::QoS(50));
  recording.add("ground_truth", "nav_msgs/msg/Odometry", rclcpp::QoS(10));
  recording.add("pf/pose/odom", "nav_msgs/msg/Odometry", rclcpp::QoS(10));
  recording.add("contacts", "std_msgs/msg/Int32", rclcpp::QoS(10));
  recording.add("laps", "std_msgs/msg/Int32", rclcpp::QoS(10));
  recording.add("mppi/eval_metrics", "slalom_msgs/msg/PlannerMetrics", rclcpp::QoS(10));
  recording.add("map", "nav_msgs/msg/OccupancyGrid", latched);
  recording.add("reference_path", "nav_msgs/msg/Path", latched);
  recording.add("obstacles", "visualization_msgs/msg/MarkerArray", latched);
  recording.add("planner_markers", "visualization_msgs/msg/MarkerArray", rclcpp::QoS(10));
}

template <class Message>
int last_number(const Recording& recording, const std::string& topic) {
  const auto all = recording.read<Message>(topic);
  return all.empty() ? 0 : all.back().data;
}

/// The stamps increase, and those of the commands follow those of the scans.
void check_stamps(const Recording& recording) {
  double last = 0;
  for (const auto& scan : recording.read<sensor_msgs::msg::LaserScan>("scan")) {
    expect(seconds(scan.header.stamp) > last, "the stamps of the scans increase");
    last = seconds(scan.header.stamp);
    expect(scan.ranges.size() == 1081, "a scan has 1081 ranges");
  }
  last = 0;
  for (const auto& drive : recording.read<AckermannDriveStamped>("drive")) {
    expect(seconds(drive.header.stamp) >= last, "the stamps of the commands increase");
    last = seconds(drive.header.stamp);
    expect(std::abs(drive.drive.steering_angle) < 0.42F && std::isfinite(drive.drive.speed),
           "a command is valid");
  }
}

/// The estimated pose is that of the simulated car. Both have the stamps of the scans.
void check_poses(const Recording& recording) {
  std::map<double, nav_msgs::msg::Odometry> truth;
  for (const auto& m : recording.read<nav_msgs::msg::Odometry>("ground_truth"))
    truth[seconds(m.header.stamp)] = m;
  double sum = 0;
  int count = 0;
  for (const auto& m : recording.read<nav_msgs::msg::Odometry>("pf/pose/odom")) {
    const auto found = truth.find(seconds(m.header.stamp));
    if (found == truth.end()) continue;
    const auto &estimate = m.pose.pose.position, &actual = found->second.pose.pose.position;
    sum += std::hypot(estimate.x - actual.x, estimate.y - actual.y);
    ++count;
  }
  expect(count > 100, "estimates of the pose, with the true pose of the same time");
  std::printf("ok: the estimated pose is %.3f m from the true one, mean of %d\n", sum / count, count);
  expect(sum / count < 0.15, "the estimated pose is that of the car");
}

void check_diagnostics(const Client& client) {
  for (const auto& [status, key] : {std::pair<const char*, const char*>{"planner: plans", "plans"},
                                    {"planner: plans", "deadlines missed"},
                                    {"planner: plans", "least effective sample size"},
                                    {"planner: plans", "latency from scan to command, p50, ms"},
                                    {"planner: plans", "latency from scan to command, p99, ms"},
                                    {"localiser: localisation", "health"},
                                    {"world: simulated car", "laps"}}) {
    const auto found = client.diagnostics.find(status);
    expect(found != client.diagnostics.end() && found->second.count(key) > 0,
           std::string("diagnostics have ") + status + ", " + key);
    std::printf("   %s, %s: %s\n", status, key, found->second.at(key).c_str());
  }
}

void test(int argc, char** argv) {
  expect(argc >= 2, "usage: race_test processes|composed [LAPS [OBSTACLES]]");
  const int laps = argc > 2 ? std::stoi(argv[2]) : 3;
  const std::string obstacles = argc > 3 ? argv[3] : "5";
  Client client("race_test");
  Recording recording(client);
  record_all(recording);
  Nodes nodes(place_of(argv[1]));
  nodes.start("world", "world", {"autostart:=true", "course:=wren", "obstacles:=" + obstacles});
  nodes.start("localiser", "localiser", {"autostart:=true", "course:=wren", "everywhere:=true"});
  nodes.start("planner", "planner", {"autostart:=true", "course:=wren", "planner.max_speed:=100.0"});
  client.wait(
      "the car drives", [&] { return client.drives(); }, 60);
  client.wait(
      std::to_string(laps) + " laps",
      [&, checked = 0.0]() mutable {
        if (steady_seconds() - checked < 0.5) return false;
        checked = steady_seconds();
        return last_number<std_msgs::msg::Int32>(recording, "laps") >= laps;
      },
      90.0 * laps);
  expect(last_number<std_msgs::msg::Int32>(recording, "contacts") == 0, "no contacts");
  for (const char* topic : {"map", "reference_path", "obstacles", "planner_markers"})
    expect(recording.count(topic) > 0, std::string("something on ") + topic);
  expect(recording.count("mppi/eval_metrics") > recording.count("scan") / 2, "plans for most scans");
  check_stamps(recording);
  check_poses(recording);
  check_diagnostics(client);
}

}  // namespace
}  // namespace slalom_ros_test

int main(int argc, char** argv) try {
  rclcpp::init(1, argv);
  slalom_ros_test::test(argc, argv);
  rclcpp::shutdown();
} catch (const std::exception& error) {
  std::printf("%s\n", error.what());
  return 1;
}
