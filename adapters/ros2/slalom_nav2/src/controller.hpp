#pragma once

#include <mutex>

#include <nav2_core/controller.hpp>

#include "logic/path_follower.hpp"

namespace slalom_ros {
class OptionParameters;
}
namespace slalom_nav2 {

/// The tolerances of a goal checker as a pose. Returns whether it tells them.
inline bool get_tolerances(nav2_core::GoalChecker& checker, geometry_msgs::msg::Pose& pose) {
  geometry_msgs::msg::Twist velocity;
#if SLALOM_NAV2_MINOR >= 5
  double length = 0;  // m, of the path
  return checker.getTolerances(pose, velocity, length);
}
using ServerNode = nav2::LifecycleNode;
#else
  return checker.getTolerances(pose, velocity);
}
using ServerNode = rclcpp_lifecycle::LifecycleNode;
#endif

/// A controller of nav2's controller server that drives with slalom::navigation, for nav2 1.3 to 1.5, of
/// which SLALOM_NAV2_MINOR is one. Its logic is in slalom::nodes::PathFollower; this has messages, frames and
/// parameters. The server may call its functions and change its parameters from several threads.
class Controller : public nav2_core::Controller {
 public:
  using Node = rclcpp_lifecycle::LifecycleNode;

  /// Throws std::exception if a parameter or the footprint breaks a rule.
  void configure(const ServerNode::WeakPtr& parent, std::string name,
                 std::shared_ptr<tf2_ros::Buffer> transforms,
                 std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap) override;
  void cleanup() override;
  void activate() override;
  void deactivate() override;

#if SLALOM_NAV2_MINOR >= 5
  void newPathReceived(const nav_msgs::msg::Path& plan) override {
    use_plan(plan);
  }
  geometry_msgs::msg::TwistStamped computeVelocityCommands(const geometry_msgs::msg::PoseStamped& pose,
                                                           const geometry_msgs::msg::Twist& velocity,
                                                           nav2_core::GoalChecker* goal_checker,
                                                           const nav_msgs::msg::Path&,
                                                           const geometry_msgs::msg::PoseStamped&) override {
    return command(pose, velocity, goal_checker);
  }
#else
  void setPlan(const nav_msgs::msg::Path& plan) override {
    use_plan(plan);
  }
  geometry_msgs::msg::TwistStamped computeVelocityCommands(const geometry_msgs::msg::PoseStamped& pose,
                                                           const geometry_msgs::msg::Twist& velocity,
                                                           nav2_core::GoalChecker* goal_checker) override {
    return command(pose, velocity, goal_checker);
  }
#endif
  /// Begins to brake; true once the robot stands.
  bool cancel() override;
  void setSpeedLimit(const double& limit, const bool& percentage) override;
  void reset() override;

 private:
  struct Outputs;

  /// Throws nav2_core::InvalidPath if it has no poses, one is not finite, or it has no frame.
  void use_plan(const nav_msgs::msg::Path& plan);
  /// Throws nav2_core::InvalidPath without a plan, ControllerTFError without a transform, NoValidControl if
  /// the path is blocked and there is no way round, and ControllerException if the costmap or the footprint
  /// is none that Slalom takes.
  geometry_msgs::msg::TwistStamped command(const geometry_msgs::msg::PoseStamped& pose,
                                           const geometry_msgs::msg::Twist& velocity,
                                           nav2_core::GoalChecker* goal_checker);
  slalom::maps::Pose frame_in_costmap(const std::string& frame, const rclcpp::Time& time) const;
  void subscribe(Node& node, const std::string& prefix);
  void read_costmap();

  // Clock and logger of the node, which owns the controller.
  rclcpp::Clock::SharedPtr clock_;
  rclcpp::Logger logger_ = rclcpp::get_logger("slalom_nav2");

  std::shared_ptr<tf2_ros::Buffer> transforms_;
  std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap_;
  std::mutex mutex_;  ///< guards the follower
  std::unique_ptr<slalom::nodes::PathFollower> follower_;
  std::shared_ptr<slalom_ros::OptionParameters> parameters_;
  std::shared_ptr<Outputs> outputs_;
  rclcpp::SubscriptionBase::SharedPtr scans_, objects_;
  std::string plan_frame_;
};

}  // namespace slalom_nav2
