#pragma once

#include <algorithm>

#include <geometry_msgs/msg/twist.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <tf2_msgs/msg/tf_message.hpp>

#include "conversions.hpp"
#include "harness.hpp"

namespace slalom_nav2_test {

using slalom::maps::Pose;

/// An axis-parallel obstacle, m.
struct Box {
  double x0, y0, x1, y1;
};

/// A simulated differential base in real time: moves as `cmd_vel` says, and publishes odometry, transforms
/// and a map with obstacles. A wait throws if the robot hits something.
class Drive : public slalom_ros_test::TestNode {
 public:
  static constexpr double radius = 0.22;  ///< m, of the robot

  Drive() : TestNode("drive") {
    odometry_out_ = node->create_publisher<nav_msgs::msg::Odometry>("/odom", 10);
    transforms_out_ = node->create_publisher<tf2_msgs::msg::TFMessage>("/tf", 100);
    map_out_ = node->create_publisher<nav_msgs::msg::OccupancyGrid>("/map", rclcpp::QoS(1).transient_local());
    commands_in_ = node->create_subscription<geometry_msgs::msg::Twist>(
        "/cmd_vel", 10, [this](const geometry_msgs::msg::Twist::ConstSharedPtr m) {
          command = *m;
          commanded_ = slalom_ros_test::steady_seconds();
        });
    show({});
  }

  /// Publishes a map from (0, -4) to (10, 10) m with these obstacles, which the robot can hit.
  void show(const std::vector<Box>& obstacles) {
    obstacles_ = obstacles;
    nav_msgs::msg::OccupancyGrid map;
    map.header.frame_id = "odom";
    map.header.stamp = node->now();
    map.info.resolution = 0.05F;
    map.info.width = 200;
    map.info.height = 280;
    map.info.origin.position.y = -4;
    map.info.origin.orientation.w = 1;
    map.data.assign(std::size_t{200} * 280, 0);
    for (std::size_t i = 0; i < map.data.size(); ++i) {
      const double x = 0.05 * static_cast<double>(i % 200) + 0.025,
                   y = 0.05 * static_cast<double>(i / 200) - 3.975;
      for (const Box& box : obstacles_)
        if (x > box.x0 && x < box.x1 && y > box.y0 && y < box.y1) map.data[i] = 100;
    }
    map_out_->publish(map);
  }

  Pose pose{1, 3, 0};
  geometry_msgs::msg::Twist command;  ///< the last

 private:
  void step() override {
    const double now = slalom_ros_test::steady_seconds(), elapsed = now - moved_;
    if (elapsed < 0.02) return;
    moved_ = now;
    if (now - commanded_ > 0.5) command = geometry_msgs::msg::Twist();
    if (elapsed < 0.5) {
      const double forward = command.linear.x * elapsed;
      pose = {pose.x + forward * std::cos(pose.yaw), pose.y + forward * std::sin(pose.yaw),
              pose.yaw + command.angular.z * elapsed};
    }
    for (const Box& box : obstacles_) {
      const double x = std::clamp(pose.x, box.x0, box.x1) - pose.x;
      const double y = std::clamp(pose.y, box.y0, box.y1) - pose.y;
      // The map's cells and the movement of a period are coarser than this.
      slalom_ros_test::expect(std::hypot(x, y) >= radius - 0.05, "the robot hits no obstacle");
    }
    nav_msgs::msg::Odometry odometry;
    odometry.header.stamp = node->now();
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose = slalom_ros::message_of(pose);
    odometry.twist.twist = command;
    odometry_out_->publish(odometry);
    tf2_msgs::msg::TFMessage transforms;
    transforms.transforms.resize(1);
    slalom_ros::set_transform(transforms.transforms[0], pose, slalom_ros::stamp_of(odometry.header.stamp));
    transforms.transforms[0].header.frame_id = "odom";
    transforms.transforms[0].child_frame_id = "base_link";
    transforms_out_->publish(transforms);
  }

  std::vector<Box> obstacles_;
  double moved_ = 0, commanded_ = 0;  // s
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_out_;
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr transforms_out_;
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr map_out_;
  rclcpp::SubscriptionBase::SharedPtr commands_in_;
};

}  // namespace slalom_nav2_test
