// nav2's own controller server loads the controller and drives a simulated robot, with a local costmap that
// moves with it: to a goal round an obstacle, to a goal behind a wall, and until it is cancelled.
//
// usage: controller_test FILE     FILE is the parameter file that it writes
#include <fstream>

#include <ament_index_cpp/get_package_prefix.hpp>
#include <lifecycle_msgs/msg/transition.hpp>
#include <lifecycle_msgs/srv/change_state.hpp>
#include <nav2_msgs/action/follow_path.hpp>
#include <rclcpp_action/rclcpp_action.hpp>

#include "drive.hpp"

namespace slalom_nav2_test {
namespace {

using lifecycle_msgs::msg::Transition;
using lifecycle_msgs::srv::ChangeState;
using nav2_msgs::action::FollowPath;
using slalom_ros_test::expect;
using GoalHandle = rclcpp_action::ClientGoalHandle<FollowPath>;

constexpr const char* parameters = R"(
controller_server:
  ros__parameters:
    controller_frequency: 20.0
    failure_tolerance: 0.3
    odom_topic: odom
    progress_checker_plugins: ["progress_checker"]
    goal_checker_plugins: ["goal_checker"]
    controller_plugins: ["FollowPath"]
    progress_checker:
      plugin: "nav2_controller::SimpleProgressChecker"
      required_movement_radius: 0.2
      movement_time_allowance: 10.0
    goal_checker:
      plugin: "nav2_controller::SimpleGoalChecker"
      xy_goal_tolerance: 0.2
      yaw_goal_tolerance: 0.3
    FollowPath:
      plugin: "slalom_nav2::Controller"
      batch_size: 1000
      vx_max: 0.5
      visualize: true
local_costmap:
  local_costmap:
    ros__parameters:
      global_frame: odom
      robot_base_frame: base_link
      rolling_window: true
      width: 6
      height: 6
      resolution: 0.05
      robot_radius: 0.22
      update_frequency: 10.0
      publish_frequency: 2.0
      plugins: ["static_layer", "inflation_layer"]
      static_layer:
        plugin: "nav2_costmap_2d::StaticLayer"
        map_topic: /map
        map_subscribe_transient_local: true
      inflation_layer:
        plugin: "nav2_costmap_2d::InflationLayer"
        inflation_radius: 0.5
        cost_scaling_factor: 3.0
)";

class ControllerTest {
 public:
  explicit ControllerTest(const std::string& file) {
    std::ofstream(file) << parameters;
    const std::string server =
        ament_index_cpp::get_package_prefix("nav2_controller") + "/lib/nav2_controller/controller_server";
    server_ = std::make_unique<slalom_ros_test::Process>(
        std::vector<std::string>{server, "--ros-args", "--params-file", file});
    follow_ = rclcpp_action::create_client<FollowPath>(drive_.node, "/follow_path");
    drive_.show({pallet});
    change(Transition::TRANSITION_CONFIGURE, "the server configures the controller");
    change(Transition::TRANSITION_ACTIVATE, "the server is active");
  }

  void drives_to_a_goal() {
    start({1, 3, 0}, {9, 3, 0});
    drive_.wait("it drives round an obstacle to the goal", 60, [&] { return ended_; });
    expect(result_.code == rclcpp_action::ResultCode::SUCCEEDED, "the goal is reached");
    expect(std::hypot(drive_.pose.x - 9, drive_.pose.y - 3) < 0.25, "the robot is there");
  }

  /// The wall is longer than the costmap sees.
  void gives_up_in_front_of_a_wall() {
    drive_.show({pallet, {3, -4, 3.2, 10}});
    drive_.run(1);
    start({9, 3, 3.1416}, {1, 3, 3.1416});
    drive_.wait("it gives up in front of a wall", 40, [&] { return ended_; });
    expect(result_.code == rclcpp_action::ResultCode::ABORTED, "the goal is aborted");
    const auto why = result_.result->error_code;
    expect(why == FollowPath::Result::PATIENCE_EXCEEDED || why == FollowPath::Result::NO_VALID_CONTROL,
           "since there is no valid control");
    expect(drive_.pose.x > 3.4, "it has not passed the wall");
  }

  void can_be_cancelled() {
    drive_.show({pallet});
    drive_.run(1);
    start({drive_.pose.x, drive_.pose.y, 0}, {9, drive_.pose.y, 0});
    drive_.wait("it drives again", 20, [&] { return std::abs(drive_.command.linear.x) > 0.1; });
    follow_->async_cancel_goal(handle_);
    drive_.wait("it can be cancelled", 5, [&] { return ended_; });
    expect(result_.code == rclcpp_action::ResultCode::CANCELED, "the goal is cancelled");
    drive_.run(0.2);
    expect(std::abs(drive_.command.linear.x) < 0.01, "the robot stands");
  }

  void ends() {
    change(Transition::TRANSITION_DEACTIVATE, "the server is inactive");
    change(Transition::TRANSITION_CLEANUP, "the server is unconfigured");
  }

 private:
  static constexpr Box pallet{4.5, 2.5, 5.5, 3.5};

  void change(unsigned char transition, const std::string& what) {
    ChangeState::Request request;
    request.transition.id = transition;
    expect(drive_.call<ChangeState>("/controller_server/change_state", request)->success, what);
  }

  /// Sends a straight path.
  void start(const Pose& from, const Pose& to) {
    FollowPath::Goal goal;
    goal.path.header.frame_id = "odom";
    goal.path.header.stamp = drive_.node->now();
    for (int i = 0; i <= 160; ++i) {
      const double share = i / 160.0;
      goal.path.poses.emplace_back();
      goal.path.poses.back().header = goal.path.header;
      goal.path.poses.back().pose = slalom_ros::message_of(
          Pose{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), to.yaw});
    }
    ended_ = false;
    handle_.reset();
    rclcpp_action::Client<FollowPath>::SendGoalOptions options;
    options.goal_response_callback = [this](const GoalHandle::SharedPtr& handle) { handle_ = handle; };
    options.result_callback = [this](const GoalHandle::WrappedResult& result) {
      result_ = result;
      ended_ = true;
    };
    drive_.wait("the server takes paths", 20, [&] { return follow_->action_server_is_ready(); });
    follow_->async_send_goal(goal, options);
    drive_.wait("the path is accepted", 10, [&] { return handle_ != nullptr; });
  }

  Drive drive_;
  std::unique_ptr<slalom_ros_test::Process> server_;
  rclcpp_action::Client<FollowPath>::SharedPtr follow_;
  GoalHandle::SharedPtr handle_;
  GoalHandle::WrappedResult result_;
  bool ended_ = false;
};

void test(const std::string& file) {
  ControllerTest all(file);
  all.drives_to_a_goal();
  all.gives_up_in_front_of_a_wall();
  all.can_be_cancelled();
  all.ends();
}

}  // namespace
}  // namespace slalom_nav2_test

int main(int argc, char** argv) {
  return slalom_ros_test::run_test(argc, argv, &slalom_nav2_test::test);
}
