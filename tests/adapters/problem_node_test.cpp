// A problem of one's own as a node: its loop, and the example with stand-ins for ROS 2.
#include <gtest/gtest.h>

#include "support/allocations.hpp"
#define main goal_node
#include "slalom_ros/examples/goal_node.cpp"
#undef main

namespace slalom_ros {
namespace {

TEST(CommandLoop, IsSafeWithoutAFreshStateOrAPlan) {
  using Loop = CommandLoop<DifferentialDrive>;
  Loop loop(slalom::SvgMppi{DifferentialDrive{}, {.horizon = 10, .input_min = {0, -2}, .input_max = {1, 2}}},
            {.safe = {{0.25, 0}}, .timeout = 0.2, .deadline = 1});
  EXPECT_EQ(loop.command(0)[0], 0.25);
  EXPECT_EQ(loop.why(), "no state yet");
  loop.hear({0, 0, 0}, 5);
  const long before = slalom::testing::allocations();
  EXPECT_GT(loop.command(5.1)[0], 0.5);
  EXPECT_EQ(slalom::testing::allocations(), before);
  EXPECT_EQ(loop.why(), "");
  ASSERT_TRUE(loop.plan());
  EXPECT_EQ(loop.plan()->states.size(), 11u);
  for (const double now : {5.21, 4.9}) {  // too old, and from the future
    EXPECT_EQ(loop.command(now)[0], 0.25);
    EXPECT_TRUE(loop.why().starts_with("the newest state is ")) << loop.why();
    EXPECT_FALSE(loop.plan());
  }
  loop.hear({NAN, 0, 0}, 6);
  EXPECT_EQ(loop.command(6)[0], 0.25);
  EXPECT_EQ(loop.why(), "non_finite_state");
  loop.hear({3, 0.2, 0}, 7);  // within the disc of the example
  EXPECT_EQ(loop.command(7)[0], 0.25);
  EXPECT_EQ(loop.why(), "all_collided");
}

TEST(ProblemNode, TheExampleDrivesToItsGoalAndStopsWithoutStates) {
  rclcpp::Node::parameters["view_port"] = 80000;
  EXPECT_THROW(goal_node(0, nullptr), std::invalid_argument);
  rclcpp::Node::parameters["view_port"] = 8460;
  EXPECT_THROW(Node("plain", slalom::SvgMppi{DifferentialDrive{}, {.horizon = 9}}, {}),
               std::invalid_argument);
  goal_node(0, nullptr);
}

/// Drives the robot of the example as its node commands.
void drive(const std::string& address) {
  auto& commands = rclcpp::Publisher<Twist>::sent;
  auto& plans = rclcpp::Publisher<std_msgs::msg::Float64MultiArray>::sent;
  EXPECT_TRUE(address.starts_with("http://127.0.0.1:")) << address;
  rclcpp::Node::tick();
  EXPECT_EQ(commands.back().linear.x, 0);
  EXPECT_EQ(rclcpp::Node::log, "no state yet");
  const DifferentialDrive robot;
  State x{};
  for (int i = 0; i < 120 && robot.distance(x) > 0.3; ++i) {
    rclcpp::Node::time.s += robot.dt;
    Odometry m;
    m.header.stamp = rclcpp::Node::time;
    m.pose.pose.position = {x.x, x.y, 0};
    m.pose.pose.orientation = {std::sin(0.5 * x.yaw), std::cos(0.5 * x.yaw)};
    rclcpp::Subscription<Odometry>::hear(m);
    rclcpp::Node::tick();
    EXPECT_EQ(plans.back().data[1], x.y);
    x = robot.step(x, {{commands.back().linear.x, commands.back().angular.z}});
    EXPECT_FALSE(robot.place_cost(x).collided) << i;
  }
  EXPECT_LT(robot.distance(x), 0.3);
  EXPECT_EQ(plans.back().data.size(), 26u * 3);
  EXPECT_GT(commands.back().linear.x, 0);
  rclcpp::Node::time.s += 1;
  rclcpp::Node::tick();
  EXPECT_EQ(commands.back().linear.x, 0);
  EXPECT_TRUE(rclcpp::Node::log.starts_with("the newest state is 1.")) << rclcpp::Node::log;
  commands.clear();
  rclcpp::Node::at_end();
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(commands.back().linear.x, 0);
}

}  // namespace
}  // namespace slalom_ros

void rclcpp::spin(const std::shared_ptr<Node>&) {
  slalom_ros::drive(Node::log);
}
