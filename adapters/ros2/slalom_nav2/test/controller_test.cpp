// nav2's own controller server loads the controller and drives a simulated robot, with a local costmap that
// moves with it: to a goal round an obstacle, to a goal behind a wall, and until it is cancelled.
//
// usage: controller_test FILE     FILE is the parameter file that it writes
#include <algorithm>
#include <fstream>

#include <ament_index_cpp/get_package_prefix.hpp>
#include <geometry_msgs/msg/twist.hpp>
#include <lifecycle_msgs/msg/transition.hpp>
#include <lifecycle_msgs/srv/change_state.hpp>
#include <nav2_msgs/action/follow_path.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <tf2_msgs/msg/tf_message.hpp>

#include "conversions.hpp"
#include "harness.hpp"

namespace slalom_nav2_test {
namespace {

using geometry_msgs::msg::Twist;
using lifecycle_msgs::msg::Transition;
using lifecycle_msgs::srv::ChangeState;
using nav2_msgs::action::FollowPath;
using slalom::maps::Pose;
using slalom_ros_test::expect;
using GoalHandle = rclcpp_action::ClientGoalHandle<FollowPath>;

constexpr const char* parameters = R"(
controller_server:
  ros__parameters:
    failure_tolerance: 0.3
    odom_topic: odom
    enable_stamped_cmd_vel: false
    controller_plugins: ["FollowPath"]
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
      plugins: ["static_layer"]
      static_layer:
        plugin: "nav2_costmap_2d::StaticLayer"
        map_topic: /map
        map_subscribe_transient_local: true
)";
constexpr double radius = 0.22;  // m, of the robot
/// A pallet on the way, and a wall that is longer than the costmap sees: x from, y from, x to, y to, m.
constexpr double obstacles[][4] = {{4.5, 2.5, 5.5, 3.5}, {12, -4, 12.2, 10}};

/// A simulated differential base in real time, and a client of the server. A wait throws at a collision.
class ControllerTest : public slalom_ros_test::TestNode {
 public:
  explicit ControllerTest(const std::string& file) : TestNode("drive") {
    std::ofstream(file) << parameters;
    const std::string server =
        ament_index_cpp::get_package_prefix("nav2_controller") + "/lib/nav2_controller/controller_server";
    server_ = std::make_unique<slalom_ros_test::Process>(
        std::vector<std::string>{server, "--ros-args", "--params-file", file});
    show_map();
    change(Transition::TRANSITION_CONFIGURE, "the server configures the controller");
    change(Transition::TRANSITION_ACTIVATE, "the server is active");
  }

  void run_all() {
    start(9);
    wait("it drives round an obstacle to the goal", 60, [&] { return ended_; });
    expect(result_.code == rclcpp_action::ResultCode::SUCCEEDED, "the goal is reached");
    expect(std::hypot(pose_.x - 9, pose_.y - 3) < 0.3, "the robot is there");
    start(15);
    wait("it gives up in front of a wall", 40, [&] { return ended_; });
    expect(result_.code == rclcpp_action::ResultCode::ABORTED, "the goal is aborted");
    const auto why = result_.result->error_code;
    expect(why == FollowPath::Result::PATIENCE_EXCEEDED || why == FollowPath::Result::NO_VALID_CONTROL,
           "since there is no valid control");
    start(6);
    wait("it drives again", 20, [&] { return std::abs(command_.linear.x) > 0.1; });
    follow_->async_cancel_goal(handle_);
    wait("it can be cancelled", 5, [&] { return ended_; });
    expect(result_.code == rclcpp_action::ResultCode::CANCELED, "the goal is cancelled");
    run(0.2);
    expect(std::abs(command_.linear.x) < 0.01, "the robot stands");
    change(Transition::TRANSITION_DEACTIVATE, "the server is inactive");
    change(Transition::TRANSITION_CLEANUP, "the server is unconfigured");
  }

 private:
  void show_map() {
    nav_msgs::msg::OccupancyGrid map;
    map.header.frame_id = "odom";
    map.info.resolution = 0.05F;
    map.info.width = 320;
    map.info.height = 280;
    map.info.origin.position.y = -4;
    map.info.origin.orientation.w = 1;
    for (std::size_t i = 0; i < std::size_t{320} * 280; ++i) {
      const double x = 0.05 * static_cast<double>(i % 320) + 0.025,
                   y = 0.05 * static_cast<double>(i / 320) - 3.975;
      const bool hit = std::any_of(std::begin(obstacles), std::end(obstacles), [&](const auto& box) {
        return x > box[0] && x < box[2] && y > box[1] && y < box[3];
      });
      map.data.push_back(hit ? 100 : 0);
    }
    map_out_->publish(map);
  }
  void change(unsigned char transition, const std::string& what) {
    ChangeState::Request request;
    request.transition.id = transition;
    expect(call<ChangeState>("/controller_server/change_state", request)->success, what);
  }
  /// Sends a straight path from the robot to (x, 3).
  void start(double x) {
    FollowPath::Goal goal;
    std::vector<Pose> way;
    for (int i = 0; i <= 160; ++i)
      way.push_back({pose_.x + i / 160.0 * (x - pose_.x), 3, x > pose_.x ? 0 : 3.1416});
    goal.path = slalom_ros::path_of(way, "odom", node->now().nanoseconds());
    ended_ = false;
    handle_.reset();
    rclcpp_action::Client<FollowPath>::SendGoalOptions options;
    options.goal_response_callback = [this](const GoalHandle::SharedPtr& handle) { handle_ = handle; };
    options.result_callback = [this](const GoalHandle::WrappedResult& result) {
      result_ = result;
      ended_ = true;
    };
    wait("the server takes paths", 20, [&] { return follow_->action_server_is_ready(); });
    follow_->async_send_goal(goal, options);
    wait("the path is accepted", 10, [&] { return handle_ != nullptr; });
  }
  void step() override {
    const double now = slalom_ros_test::steady_seconds(), elapsed = now - moved_;
    if (elapsed < 0.02) return;
    moved_ = now;
    if (now - commanded_ > 0.5) command_ = Twist();
    if (elapsed < 0.5) {
      pose_ = slalom_ros::nodes::moved_ahead(pose_, command_.linear.x * elapsed);
      pose_.yaw += command_.angular.z * elapsed;
    }
    for (const auto& box : obstacles)  // the map's cells and the movement of a period are coarser than 0.05 m
      expect(std::hypot(std::clamp(pose_.x, box[0], box[2]) - pose_.x,
                        std::clamp(pose_.y, box[1], box[3]) - pose_.y) >= radius - 0.05,
             "the robot hits no obstacle");
    nav_msgs::msg::Odometry odometry;
    odometry.header.stamp = node->now();
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose = slalom_ros::message_of(pose_);
    odometry.twist.twist = command_;
    odometry_out_->publish(odometry);
    tf2_msgs::msg::TFMessage transforms;
    transforms.transforms.resize(1);
    slalom_ros::set_transform(transforms.transforms[0], pose_, slalom_ros::stamp_of(odometry.header.stamp));
    transforms.transforms[0].header.frame_id = "odom";
    transforms.transforms[0].child_frame_id = "base_link";
    transforms_out_->publish(transforms);
  }

  Pose pose_{1, 3, 0};
  Twist command_;                     // the last
  double moved_ = 0, commanded_ = 0;  // s
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_out_ =
      node->create_publisher<nav_msgs::msg::Odometry>("/odom", 10);
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr transforms_out_ =
      node->create_publisher<tf2_msgs::msg::TFMessage>("/tf", 100);
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr map_out_ =
      node->create_publisher<nav_msgs::msg::OccupancyGrid>("/map", rclcpp::QoS(1).transient_local());
  rclcpp::SubscriptionBase::SharedPtr commands_in_ =
      node->create_subscription<Twist>("/cmd_vel", 10, [this](const Twist::ConstSharedPtr m) {
        command_ = *m;
        commanded_ = slalom_ros_test::steady_seconds();
      });
  std::unique_ptr<slalom_ros_test::Process> server_;
  rclcpp_action::Client<FollowPath>::SharedPtr follow_ =
      rclcpp_action::create_client<FollowPath>(node, "/follow_path");
  GoalHandle::SharedPtr handle_;
  GoalHandle::WrappedResult result_;
  bool ended_ = false;
};

void test(const std::string& file) {
  ControllerTest(file).run_all();
}

}  // namespace
}  // namespace slalom_nav2_test

int main(int argc, char** argv) {
  return slalom_ros_test::run_test(argc, argv, &slalom_nav2_test::test);
}
