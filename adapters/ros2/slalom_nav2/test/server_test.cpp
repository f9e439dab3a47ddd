// Loads the controller as nav2's controller server does, and plays that server: parameters, plans, the
// command of every period, refusals, cancellation.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "server.hpp"

namespace slalom_nav2_test {
namespace {

void done(const char* what) {
  std::printf("ok: %s\n", what);
  std::fflush(stdout);
}

/// Walls around, a pallet in the middle, and what an inflation layer would write around it.
void furnish(Server& server) {
  server.fill(4.3, 2.3, 5.7, 3.7, nav2_costmap_2d::INSCRIBED_INFLATED_OBSTACLE);
  server.fill(4.5, 2.5, 5.5, 3.5);
  server.fill(0, 0, 10, 0.1);
  server.fill(0, 5.9, 10, 6);
}

void drives_round_an_obstacle_to_the_goal() {
  Server server({{"FollowPath.visualize", true}});
  server.configure();
  furnish(server);
  // The plan is given in a map that is turned against the odometry: its x axis points along -y.
  server.place("map", {0, 10, -std::acos(0.0)});
  server.controller->setPlan(Server::plan("map", {7, 1, 0}, {7, 9, std::acos(0.0)}));
  const auto goal = slalom_ros::message_of(Pose{9, 3, 0});
  double aside = 0;
  while (!server.checker.isGoalReached(slalom_ros::message_of(server.pose), goal, server.velocity)) {
    server.step();
    expect(!server.collides(), "it touches no obstacle");
    expect(server.velocity.linear.x <= 0.5 + 1e-6, "it drives at most vx_max");
    aside = std::max(aside, std::abs(server.pose.y - 3));
    expect(server.time() < 1060, "it reaches the goal within 60 s");
  }
  expect(aside > 0.5, "the pallet was on the path");
  server.controller->reset();
  server.controller->deactivate();
  server.controller->cleanup();
  done("drives round an obstacle to the goal, along a plan of another frame");
}

void refuses_a_blocked_path() {
  Server server;
  server.configure();
  server.controller->setPlan(Server::plan("odom", {1, 3, 0}, {9, 3, 0}));
  for (int i = 0; i < 40; ++i) server.step();
  expect(server.velocity.linear.x > 0.3, "it drives");
  server.fill(5, 0, 5.2, 6);
  const double begin = server.time();
  bool refused = false;
  while (!refused && server.time() - begin < 2) {
    try {
      server.step();
    } catch (const nav2_core::NoValidControl& error) {
      refused = true;
      std::printf("   after %.2f s: %s\n", server.time() - begin, error.what());
    }
  }
  expect(refused && server.time() - begin <= 0.5 + 1e-6, "a blocked path is NoValidControl within 0.5 s");
  server.fill(5, 0, 5.2, 6, nav2_costmap_2d::FREE_SPACE);
  server.velocity = geometry_msgs::msg::Twist();
  for (int i = 0; i < 20; ++i) server.step();
  expect(server.velocity.linear.x > 0.3, "it drives on when the way is open");
  done("refuses a blocked path");
}

template <class Error, class Call>
void expect_error(const char* what, Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    std::printf("   %s: %s\n", what, error.what());
    return;
  }
  expect(false, what);
}

void refuses_what_is_no_path() {
  Server server;
  server.configure();
  expect_error<nav2_core::InvalidPath>("without a plan", [&] { server.step(); });
  nav_msgs::msg::Path plan;
  plan.header.frame_id = "odom";
  expect_error<nav2_core::InvalidPath>("without poses", [&] { server.controller->setPlan(plan); });
  plan = Server::plan("", {1, 3, 0}, {9, 3, 0});
  expect_error<nav2_core::InvalidPath>("without a frame", [&] { server.controller->setPlan(plan); });
  plan.header.frame_id = "nowhere";
  server.controller->setPlan(plan);
  expect_error<nav2_core::ControllerTFError>("of an unknown frame", [&] { server.step(); });
  plan.header.frame_id = "odom";
  server.controller->setPlan(plan);
  server.step();
  server.controller->reset();
  expect_error<nav2_core::InvalidPath>("after a reset", [&] { server.step(); });
  done("refuses what is no path");
}

void keeps_to_speed_limits_and_stops_when_cancelled() {
  Server server;
  server.configure();
  server.controller->setPlan(Server::plan("odom", {1, 3, 0}, {9, 3, 0}));
  server.controller->setSpeedLimit(50, true);
  for (int i = 0; i < 40; ++i) server.step();
  expect(std::abs(server.velocity.linear.x - 0.25) < 0.04, "50 % of 0.5 m/s");
  server.controller->setSpeedLimit(0.4, false);
  for (int i = 0; i < 40; ++i) server.step();
  expect(std::abs(server.velocity.linear.x - 0.4) < 0.04, "0.4 m/s");
  server.controller->setSpeedLimit(-1, false);
  for (int i = 0; i < 10; ++i) server.step();
  expect(std::abs(server.velocity.linear.x - 0.4) < 0.04, "a limit below 0 is none and is not taken");
  int periods = 0;
  for (; !server.controller->cancel(); ++periods) {
    server.step();
    expect(periods < 20, "a cancelled controller stands within a second");
  }
  expect(periods >= 2 && server.velocity.linear.x < 0.01, "it brakes");
  done("keeps to speed limits and stops when cancelled");
}

void has_parameters() {
  Server server({{"FollowPath.vx_max", 0.8}, {"FollowPath.costs.path", 3.0}, {"FollowPath.critics", "none"}});
  server.configure();
  expect(server.node->get_parameter("FollowPath.vx_max").as_double() == 0.8, "the user's value holds");
  const auto described = server.node->describe_parameter("FollowPath.vx_max");
  expect(!described.description.empty() && described.floating_point_range.size() == 1 &&
             described.additional_constraints == "must be in [0.01, 20]",
         "a parameter has description, range and rule");
  const auto set = [&](const std::string& name, const rclcpp::ParameterValue& value) {
    return server.node->set_parameter(rclcpp::Parameter(name, value));
  };
  expect(!set("FollowPath.vx_max", rclcpp::ParameterValue(-3.0)).successful,
         "a value out of range is refused");
  expect(server.node->get_parameter("FollowPath.vx_max").as_double() == 0.8, "then it is unchanged");
  const auto refused = set("FollowPath.motion_model", rclcpp::ParameterValue(std::string("Boat")));
  expect(!refused.successful && refused.reason.find("DiffDrive") != std::string::npos, "with the rule");
  expect(!set("FollowPath.method", rclcpp::ParameterValue(std::string("mppi"))).successful,
         "the method is fixed");

  server.controller->setPlan(Server::plan("odom", {1, 3, 0}, {9, 3, 0}));
  for (int i = 0; i < 40; ++i) server.step();
  expect(server.velocity.linear.x > 0.6, "it drives as fast as vx_max allows");
  expect(set("FollowPath.vx_max", rclcpp::ParameterValue(0.3)).successful, "vx_max may change");
  for (int i = 0; i < 40; ++i) server.step();
  expect(std::abs(server.velocity.linear.x - 0.3) < 0.04, "and it drives slower");
  done("has parameters that may change");
}

void refuses_wrong_parameters() {
  const auto refuses = [](const char* what, const rclcpp::Parameter& parameter) {
    Server server({parameter});
    expect_error<std::exception>(what, [&] { server.configure(); });
  };
  refuses("out of range", {"FollowPath.time_steps", 0});
  refuses("not of its type", {"FollowPath.vx_max", 1});
  refuses("none of its section", {"FollowPath.costs.none", 1.0});
  refuses("an unknown method", {"FollowPath.method", "none"});
  done("refuses wrong parameters");
}

}  // namespace
}  // namespace slalom_nav2_test

int main(int argc, char** argv) try {
  rclcpp::init(argc, argv);
  slalom_nav2_test::drives_round_an_obstacle_to_the_goal();
  slalom_nav2_test::refuses_a_blocked_path();
  slalom_nav2_test::refuses_what_is_no_path();
  slalom_nav2_test::keeps_to_speed_limits_and_stops_when_cancelled();
  slalom_nav2_test::has_parameters();
  slalom_nav2_test::refuses_wrong_parameters();
  rclcpp::shutdown();
} catch (const std::exception& error) {
  std::printf("%s\n", error.what());
  return 1;
}
