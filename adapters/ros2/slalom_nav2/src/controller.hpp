#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <nav2_core/controller.hpp>

#include "logic/path_follower.hpp"
#include "option_parameters.hpp"

namespace slalom_nav2 {

/// A controller of nav2's controller server that drives with slalom::navigation. Its logic is in
/// slalom::nodes::PathFollower; this has messages, frames and parameters. The server may call its functions
/// and change its parameters from several threads.
class Controller : public nav2_core::Controller {
 public:
  /// Throws std::exception if a parameter or the footprint breaks a rule.
  void configure(const rclcpp_lifecycle::LifecycleNode::WeakPtr& parent, std::string name,
                 std::shared_ptr<tf2_ros::Buffer> transforms,
                 std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap) override;
  void cleanup() override;
  void activate() override;
  void deactivate() override;

  /// Throws nav2_core::InvalidPath if it has no poses, one is not finite, or it has no frame.
  void setPlan(const nav_msgs::msg::Path& plan) override;
  /// Throws nav2_core::InvalidPath without a plan, ControllerTFError without a transform, NoValidControl if
  /// the path is blocked and there is no way round, and ControllerException if the costmap or the footprint
  /// is none that Slalom takes.
  geometry_msgs::msg::TwistStamped computeVelocityCommands(const geometry_msgs::msg::PoseStamped& pose,
                                                           const geometry_msgs::msg::Twist& velocity,
                                                           nav2_core::GoalChecker* goal_checker) override;
  /// Begins to brake; true once the robot stands.
  bool cancel() override;
  void setSpeedLimit(const double& limit, const bool& percentage) override;
  void reset() override;

 private:
  using PathPublisher = rclcpp_lifecycle::LifecyclePublisher<nav_msgs::msg::Path>;

  slalom::maps::Pose frame_in_costmap(const std::string& frame, const rclcpp::Time& time) const;
  void read_costmap();
  void publish(const rclcpp::Time& time);

  // Clock and logger of the node, which owns the controller.
  rclcpp::Clock::SharedPtr clock_;
  rclcpp::Logger logger_ = rclcpp::get_logger("slalom_nav2");

  std::shared_ptr<tf2_ros::Buffer> transforms_;
  std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap_;
  std::mutex mutex_;  ///< guards the follower
  std::unique_ptr<slalom::nodes::PathFollower> follower_;
  std::unique_ptr<slalom_ros::OptionParameters> parameters_;
  std::shared_ptr<PathPublisher> predicted_out_, path_out_;
  std::string plan_frame_;
};

}  // namespace slalom_nav2
