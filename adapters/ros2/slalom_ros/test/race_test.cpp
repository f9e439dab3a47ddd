// Laps among parked cars: simulator, localiser and planner, each a process or all composed in one.
//
// usage: race_test processes|composed
#include <cmath>

#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <nav_msgs/msg/path.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <slalom_msgs/msg/planner_metrics.hpp>
#include <std_msgs/msg/int32.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "client.hpp"
#include "nodes.hpp"

namespace slalom_ros_test {
namespace {

using ackermann_msgs::msg::AckermannDriveStamped;
using nav_msgs::msg::Odometry;
using sensor_msgs::msg::LaserScan;
using std_msgs::msg::Int32;
using visualization_msgs::msg::MarkerArray;

double seconds(const builtin_interfaces::msg::Time& time) {
  return time.sec + 1e-9 * time.nanosec;
}

template <class Message>
void expect_increasing_stamps(const std::vector<Message>& messages, const std::string& name) {
  for (std::size_t i = 1; i < messages.size(); ++i)
    expect(seconds(messages[i].header.stamp) >= seconds(messages[i - 1].header.stamp),
           "the stamps of the " + name + " increase");
}

/// The estimated pose is that of the simulated car. Both have the stamps of the scans.
void check_poses(const std::vector<Odometry>& true_poses, const std::vector<Odometry>& estimates) {
  std::map<double, geometry_msgs::msg::Point> truth;
  for (const auto& m : true_poses) truth[seconds(m.header.stamp)] = m.pose.pose.position;
  double sum = 0;
  int count = 0;
  for (const auto& m : estimates) {
    const auto found = truth.find(seconds(m.header.stamp));
    if (found == truth.end()) continue;
    const auto& estimate = m.pose.pose.position;
    sum += std::hypot(estimate.x - found->second.x, estimate.y - found->second.y);
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

void test(const std::string& place) {
  Client client("race_test");
  const rclcpp::QoS some(50), latched = rclcpp::QoS(1).transient_local();
  const auto scans = client.record<LaserScan>("scan", rclcpp::SensorDataQoS());
  const auto commands = client.record<AckermannDriveStamped>("drive", some);
  const auto truth = client.record<Odometry>("ground_truth", some);
  const auto estimates = client.record<Odometry>("pf/pose/odom", some);
  const auto contacts = client.record<Int32>("contacts", some);
  const auto laps = client.record<Int32>("laps", some);
  const auto plans = client.record<slalom_msgs::msg::PlannerMetrics>("mppi/eval_metrics", some);
  const auto map = client.record<nav_msgs::msg::OccupancyGrid>("map", latched);
  const auto path = client.record<nav_msgs::msg::Path>("reference_path", latched);
  const auto parked = client.record<MarkerArray>("obstacles", latched);
  const auto markers = client.record<MarkerArray>("planner_markers", some);
  Nodes nodes(place);
  nodes.start("world", "world", {"autostart:=true", "course:=wren", "obstacles:=5"});
  nodes.start("localiser", "localiser", {"autostart:=true", "course:=wren", "everywhere:=true"});
  nodes.start("planner", "planner", {"autostart:=true", "course:=wren", "planner.max_speed:=100.0"});
  client.wait("the car drives", 60, [&] { return client.drives(); });
  client.wait("3 laps", 270, [&] { return !laps->empty() && laps->back().data >= 3; });
  expect(!contacts->empty() && contacts->back().data == 0, "no contacts");
  expect(!map->empty() && !path->empty(), "a map and a path");
  expect(!parked->empty() && !markers->empty(), "markers of parked cars and of plans");
  expect(plans->size() > scans->size() / 2, "plans for most scans");
  expect_increasing_stamps(*scans, "scans");
  expect_increasing_stamps(*commands, "commands");
  for (const LaserScan& scan : *scans) expect(scan.ranges.size() == 1081, "a scan has 1081 ranges");
  for (const AckermannDriveStamped& m : *commands)
    expect(std::abs(m.drive.steering_angle) < 0.42F && std::isfinite(m.drive.speed), "a command is valid");
  check_poses(*truth, *estimates);
  check_diagnostics(client);
}

}  // namespace
}  // namespace slalom_ros_test

int main(int argc, char** argv) {
  return slalom_ros_test::run_test(argc, argv, &slalom_ros_test::test);
}
