// A problem of one's own as a node: a robot with two wheels drives to a goal among discs. Its pose comes from
// `odom`, and its speeds go to `cmd_vel`.
#include <geometry_msgs/msg/twist.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <slalom/problems/differential_drive.hpp>
#include <slalom/slalom.hpp>
#include <slalom_ros/problem_node.hpp>

using geometry_msgs::msg::Twist;
using nav_msgs::msg::Odometry;
using slalom::problems::DifferentialDrive;
using State = DifferentialDrive::State<double>;
using Node = slalom_ros::ProblemNode<Odometry, Twist, DifferentialDrive>;

int main(int count, char** words) {
  rclcpp::init(count, words);
  const slalom::SvgMppi controller{
      DifferentialDrive{}, {.horizon = 25, .samples = 512, .input_min = {0, -2}, .input_max = {1.5, 2}}};
  const auto state = [](const Odometry& m) {
    const auto& [position, orientation] = std::tie(m.pose.pose.position, m.pose.pose.orientation);
    return State{position.x, position.y, 2 * std::atan2(orientation.z, orientation.w)};
  };
  const auto command = [](const slalom::Input<double, 2>& u) {
    Twist message;
    message.linear.x = u[0];
    message.angular.z = u[1];
    return message;
  };
  rclcpp::spin(std::make_shared<Node>(
      "goal", controller,
      Node::Settings{.state_topic = "odom",
                     .command_topic = "cmd_vel",
                     .state = state,
                     .command = command,
                     .loop = {.safe = {}, .timeout = 0.3, .deadline = 0.02},
                     .period = 0.1,
                     .drawing = {{.x = &State::x, .y = &State::y, .heading = &State::yaw}}}));
  rclcpp::shutdown();
  return 0;
}
