#pragma once

#include <memory>
#include <string>

// What nav2_core 1.3 to 1.5 ask of a controller and offer as goal checker, and the types that these name.
namespace geometry_msgs::msg {
struct Pose {};
struct PoseStamped;
struct Twist {};
struct TwistStamped {};
}  // namespace geometry_msgs::msg
namespace nav_msgs::msg {
struct Path;
}  // namespace nav_msgs::msg
namespace rclcpp {
struct Clock {
  using SharedPtr = std::shared_ptr<Clock>;
};
struct Logger {};
Logger get_logger(const char* name);
struct SubscriptionBase {
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
};
struct Time;
}  // namespace rclcpp
namespace rclcpp_lifecycle {
struct LifecycleNode {
  using WeakPtr = std::weak_ptr<LifecycleNode>;
};
}  // namespace rclcpp_lifecycle
namespace tf2_ros {
struct Buffer;
}  // namespace tf2_ros
namespace nav2_costmap_2d {
struct Costmap2DROS;
}  // namespace nav2_costmap_2d
namespace nav2 {
struct LifecycleNode : rclcpp_lifecycle::LifecycleNode {
  using WeakPtr = std::weak_ptr<LifecycleNode>;
};
}  // namespace nav2

namespace nav2_core {
using geometry_msgs::msg::PoseStamped, geometry_msgs::msg::Twist, geometry_msgs::msg::TwistStamped;
using Costmap = std::shared_ptr<nav2_costmap_2d::Costmap2DROS>;
using Transforms = std::shared_ptr<tf2_ros::Buffer>;
#if SLALOM_NAV2_MINOR >= 5
struct GoalChecker {
  bool getTolerances(geometry_msgs::msg::Pose& pose, Twist& velocity, double& path_length);
};
struct Controller {
  virtual void configure(const nav2::LifecycleNode::WeakPtr&, std::string name, Transforms, Costmap) = 0;
  virtual void newPathReceived(const nav_msgs::msg::Path& raw_global_path) = 0;
  virtual TwistStamped computeVelocityCommands(const PoseStamped&, const Twist&, GoalChecker*,
                                               const nav_msgs::msg::Path&, const PoseStamped& goal) = 0;
#else
struct GoalChecker {
  bool getTolerances(geometry_msgs::msg::Pose& pose, Twist& velocity);
};
struct Controller {
  virtual void configure(const rclcpp_lifecycle::LifecycleNode::WeakPtr&, std::string name, Transforms,
                         Costmap) = 0;
  virtual void setPlan(const nav_msgs::msg::Path& path) = 0;
  virtual TwistStamped computeVelocityCommands(const PoseStamped&, const Twist&, GoalChecker*) = 0;
#endif
  virtual ~Controller() = default;
  virtual void cleanup() = 0;
  virtual void activate() = 0;
  virtual void deactivate() = 0;
  virtual bool cancel();
  virtual void setSpeedLimit(const double& speed_limit, const bool& percentage) = 0;
  virtual void reset();
};
}  // namespace nav2_core
