#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <tf2_msgs/msg/tf_message.hpp>

#include "client.hpp"
#include "conversions.hpp"
#include "test/faulty_car.hpp"

namespace slalom_ros_test {

using slalom::nodes::testing::Fault;
using slalom::nodes::testing::ScanMessage;

/// A simulated car on the topics of ROS 2, with the faults of faults.csv. It publishes scans, odometry,
/// transforms, the map and the clock, and follows the commands of the client. Like a real car it brakes
/// without a command for 0.2 s.
class Car {
 public:
  Car(Client& client, const std::string& course, int obstacles)
      : client_(client),
        car_(course, 1, obstacles),
        scan_out_(publisher<sensor_msgs::msg::LaserScan>("scan", rclcpp::SensorDataQoS())),
        odometry_out_(publisher<nav_msgs::msg::Odometry>("odom", rclcpp::QoS(10))),
        tf_out_(publisher<tf2_msgs::msg::TFMessage>("/tf", rclcpp::QoS(100))),
        tf_static_out_(publisher<tf2_msgs::msg::TFMessage>("/tf_static", rclcpp::QoS(1).transient_local())),
        map_out_(publisher<nav_msgs::msg::OccupancyGrid>("map", rclcpp::QoS(1).transient_local())),
        clock_out_(publisher<rosgraph_msgs::msg::Clock>("/clock", rclcpp::SensorDataQoS())) {
    send_mount();
    send_map();
    client_.each_turn = [this] { turn(); };
  }

  void begin(const Fault& fault) {
    car_.begin(fault);
    if (fault.of == "map") send_map();
    if (fault.of == "clock") ahead_ += fault.value;
  }
  void end() {
    const bool was_of_map = car_.has("map", "resolution");
    car_.end();
    if (was_of_map) send_map();
  }
  bool stands() const { return car_.stands(); }

 private:
  template <class Message>
  typename rclcpp::Publisher<Message>::SharedPtr publisher(const char* topic, const rclcpp::QoS& qos) {
    return client_.node->create_publisher<Message>(topic, qos);
  }
  static builtin_interfaces::msg::Time time_of(double seconds) {
    return slalom_ros::time_of(slalom::nodes::stamp_of(seconds));
  }
  double now() const {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count() +
           ahead_;
  }

  void turn() {
    constexpr double clock_period = 0.004, period = 0.025;  // s
    const double steady = steady_seconds();
    if (steady - clock_sent_ >= clock_period) {
      clock_sent_ = steady;
      rosgraph_msgs::msg::Clock clock;
      clock.clock = time_of(now());
      clock_out_->publish(clock);
    }
    if (steady - stepped_ < period) return;
    stepped_ = steady - stepped_ < 2 * period ? stepped_ + period : steady;
    const bool commanded = steady - client_.commanded_at < 0.2;
    const double stamp = now();
    car_.step({client_.steer, commanded ? client_.speed : 0}, stamp);
    if (!car_.has("world", "dies")) send_transform(stamp);
    for (const auto& m : car_.odometry) send(m);
    for (const auto& m : car_.scans) send(m);
  }

  void send(const slalom::nodes::OdometrySample& m) {
    nav_msgs::msg::Odometry odometry;
    odometry.header.stamp = slalom_ros::time_of(m.stamp);
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose = slalom_ros::message_of(m.pose);
    odometry.twist.twist.linear.x = m.speed;
    odometry.twist.twist.angular.z = m.yaw_rate;
    odometry_out_->publish(odometry);
  }

  void send_transform(double stamp) {
    if (car_.has("tf", "silent")) return;
    tf2_msgs::msg::TFMessage m;
    m.transforms.resize(1);
    m.transforms[0].header.frame_id = "odom";
    m.transforms[0].child_frame_id = "base_link";
    slalom::maps::Pose pose = car_.car().odometry().pose();
    if (car_.has("odometry", "jumps") && !car_.odometry.empty()) pose = car_.odometry.back().pose;
    if (car_.has("tf", "not a number")) pose.x = std::numeric_limits<double>::quiet_NaN();
    const double shift = car_.has("tf", "stamp") ? car_.fault()->value : 0;  // s
    slalom_ros::set_transform(m.transforms[0], pose, slalom::nodes::stamp_of(stamp + shift));
    tf_out_->publish(m);
  }

  void send(const ScanMessage& m) {
    sensor_msgs::msg::LaserScan scan;
    scan.header.stamp = slalom_ros::time_of(m.stamp);
    scan.header.frame_id = "laser";
    scan.angle_min = static_cast<float>(m.description.angle_min);
    scan.angle_max = static_cast<float>(m.angle_max);
    scan.angle_increment = static_cast<float>(m.description.angle_increment);
    scan.range_min = static_cast<float>(m.description.range_min);
    scan.range_max = static_cast<float>(m.description.range_max);
    scan.ranges = m.ranges;
    scan_out_->publish(scan);
  }

  void send_mount() {
    tf2_msgs::msg::TFMessage m;
    m.transforms.resize(1);
    m.transforms[0].header.frame_id = "base_link";
    m.transforms[0].child_frame_id = "laser";
    slalom_ros::set_transform(m.transforms[0], car_.car().laser(), slalom::nodes::stamp_of(now()));
    tf_static_out_->publish(m);
  }
  void send_map() { map_out_->publish(slalom_ros::message_of(car_.map(), "map")); }

  Client& client_;
  slalom::nodes::testing::FaultyCar car_;
  double ahead_ = 0, clock_sent_ = 0, stepped_ = 0;  // s
  rclcpp::Publisher<sensor_msgs::msg::LaserScan>::SharedPtr scan_out_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_out_;
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr tf_out_, tf_static_out_;
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr map_out_;
  rclcpp::Publisher<rosgraph_msgs::msg::Clock>::SharedPtr clock_out_;
};

}  // namespace slalom_ros_test
