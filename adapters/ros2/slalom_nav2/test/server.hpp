#pragma once

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <rcl/time.h>
#include <tf2_ros/buffer.h>
#include <lifecycle_msgs/msg/state.hpp>
#include <nav2_core/controller.hpp>
#include <nav2_core/controller_exceptions.hpp>
#include <nav2_core/goal_checker.hpp>
#include <pluginlib/class_loader.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "conversions.hpp"

namespace slalom_nav2_test {

using slalom::maps::Pose;

inline void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("FAILED: " + what);
}

/// Content with a distance and a heading.
class Checker : public nav2_core::GoalChecker {
 public:
  static constexpr double distance = 0.15, angle = 0.3;  ///< m, rad

  void initialize(const rclcpp_lifecycle::LifecycleNode::WeakPtr&, const std::string&,
                  const std::shared_ptr<nav2_costmap_2d::Costmap2DROS>) override {}
  void reset() override {}
  bool isGoalReached(const geometry_msgs::msg::Pose& at, const geometry_msgs::msg::Pose& goal,
                     const geometry_msgs::msg::Twist&) override {
    const double turn = slalom_ros::yaw_of(at.orientation) - slalom_ros::yaw_of(goal.orientation);
    return std::hypot(at.position.x - goal.position.x, at.position.y - goal.position.y) <= distance &&
           std::abs(std::remainder(turn, 6.283185307179586)) <= angle;
  }
  bool getTolerances(geometry_msgs::msg::Pose& pose, geometry_msgs::msg::Twist&) override {
    pose.position.x = pose.position.y = distance;
    pose.orientation = slalom_ros::quaternion(angle);
    return true;
  }
};

/// Plays nav2's controller server for one controller, in simulated time, with a costmap of 10 x 6 m around
/// the robot of a simulated differential base with a radius of 0.22 m.
class Server {
 public:
  static constexpr double period = 0.05;  ///< s
  static constexpr double radius = 0.22;  ///< m

  explicit Server(std::vector<rclcpp::Parameter> parameters = {}) {
    parameters.emplace_back("FollowPath.plugin", "slalom_nav2::Controller");
    node = std::make_shared<rclcpp_lifecycle::LifecycleNode>(
        "controller_server", rclcpp::NodeOptions().parameter_overrides(parameters));
    node->declare_parameter<std::string>("FollowPath.plugin", "");  // as the server does
    if (rcl_enable_ros_time_override(node->get_clock()->get_clock_handle()) != RCL_RET_OK)
      throw std::runtime_error("the time cannot be simulated");
    pass_time(1000);
    // Its clock goes on, so that waiting for a transform ends.
    transforms = std::make_shared<tf2_ros::Buffer>(std::make_shared<rclcpp::Clock>());
    transforms->setUsingDedicatedThread(true);

    costmap = std::make_shared<nav2_costmap_2d::Costmap2DROS>("local_costmap", "/", "local_costmap", false);
    costmap->set_parameters({{"plugins", std::vector<std::string>{}},
                             {"global_frame", "odom"},
                             {"width", 10},
                             {"height", 6},
                             {"resolution", 0.05},
                             {"robot_radius", radius},
                             {"footprint_padding", 0.0}});
    expect(costmap->configure().id() == lifecycle_msgs::msg::State::PRIMARY_STATE_INACTIVE,
           "the costmap is configured");
    controller = loader_.createSharedInstance("slalom_nav2::Controller");
  }
  ~Server() {
    controller.reset();
    // A costmap whose thread has not begun to spin does not end: Executor::cancel has no effect before.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    costmap->cleanup();
  }
  void configure() {
    controller->configure(node, "FollowPath", transforms, costmap);
    controller->activate();
  }

  /// Costs of the cells in a rectangle, m.
  void fill(double x0, double y0, double x1, double y1,
            unsigned char cost = nav2_costmap_2d::LETHAL_OBSTACLE) {
    each_cell([&](double x, double y, unsigned int column, unsigned int row) {
      if (x > x0 && x < x1 && y > y0 && y < y1) cells().setCost(column, row, cost);
    });
  }
  /// Whether the robot overlaps an obstacle.
  bool collides() {
    bool found = false;
    each_cell([&](double x, double y, unsigned int column, unsigned int row) {
      found = found || (cells().getCost(column, row) == nav2_costmap_2d::LETHAL_OBSTACLE &&
                        std::hypot(x - pose.x, y - pose.y) < radius);
    });
    return found;
  }
  /// A frame of a plan, by its pose in that of the costmap.
  void place(const std::string& frame, const Pose& at) {
    geometry_msgs::msg::TransformStamped transform;
    transform.header.frame_id = "odom";
    transform.child_frame_id = frame;
    slalom_ros::set_transform(transform, at, 0);
    transforms->setTransform(transform, "test", true);
  }

  /// A straight plan, with poses every 5 cm.
  static nav_msgs::msg::Path plan(const std::string& frame, const Pose& from, const Pose& to) {
    nav_msgs::msg::Path path;
    path.header.frame_id = frame;
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const int count = static_cast<int>(length / 0.05);
    for (int i = 0; i <= count; ++i) {
      path.poses.emplace_back();
      const double share = static_cast<double>(i) / count;
      path.poses.back().pose = slalom_ros::message_of(
          {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), to.yaw});
    }
    return path;
  }

  /// One period: asks for a command and moves the robot. Throws what the controller throws.
  geometry_msgs::msg::Twist step() {
    pass_time(time_ + period);
    geometry_msgs::msg::PoseStamped at;
    at.header.frame_id = "odom";
    at.header.stamp = node->now();
    at.pose = slalom_ros::message_of(pose);
    const auto command = controller->computeVelocityCommands(at, velocity, &checker);
    velocity = command.twist;
    const double forward = velocity.linear.x;
    pose = {pose.x + period * forward * std::cos(pose.yaw), pose.y + period * forward * std::sin(pose.yaw),
            pose.yaw + period * velocity.angular.z};
    expect(command.header.frame_id == "base_link", "a command is in the frame of the base");
    expect(velocity.linear.y == 0, "a differential base does not drive sideways");
    return velocity;
  }
  double time() const { return time_; }  ///< s

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node;
  std::shared_ptr<tf2_ros::Buffer> transforms;
  std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap;
  Checker checker;
  Pose pose{1, 3, 0};  ///< pose of the robot, frame of the costmap
  geometry_msgs::msg::Twist velocity;

 private:
  pluginlib::ClassLoader<nav2_core::Controller> loader_{"nav2_core", "nav2_core::Controller"};

 public:
  std::shared_ptr<nav2_core::Controller> controller;  ///< ends before its library

 private:
  nav2_costmap_2d::Costmap2D& cells() { return *costmap->getCostmap(); }
  void each_cell(const std::function<void(double, double, unsigned int, unsigned int)>& visit) {
    for (unsigned int row = 0; row < cells().getSizeInCellsY(); ++row)
      for (unsigned int column = 0; column < cells().getSizeInCellsX(); ++column) {
        double x = 0, y = 0;
        cells().mapToWorld(column, row, x, y);
        visit(x, y, column, row);
      }
  }
  void pass_time(double time) {
    time_ = time;
    if (rcl_set_ros_time_override(node->get_clock()->get_clock_handle(),
                                  static_cast<rcl_time_point_value_t>(1e9 * time)) != RCL_RET_OK)
      throw std::runtime_error("the time cannot be simulated");
  }

  double time_ = 0;
};

}  // namespace slalom_nav2_test
