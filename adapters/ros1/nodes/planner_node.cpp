// The controller: listens to `scan` and `pf/pose/odom`, sends `drive` at 40 Hz. Where either is missing,
// late, from the future or not usable, it sends speed 0 and says why, and goes on by itself once they are
// well again.
#include <ackermann_msgs/AckermannDriveStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "ros_forms.hpp"

using namespace slalom_ros;

namespace {

/// What is wrong with the age of an input; empty if nothing.
template <class Message>
std::string fault(const Message& message, const char* what, double most_age) {
  if (!message) return std::string("no ") + what + " yet";
  const double age = (ros::Time::now() - message->header.stamp).toSec();
  if (age > most_age) return std::string(what) + " is " + std::to_string(age) + " s old";
  if (age < -0.05) return std::string(what) + " is from the future";
  return "";
}

}  // namespace

int main(int argc, char** argv) try {
  ros::init(argc, argv, "planner");
  ros::NodeHandle node, own("~");
  slalom_bridge::Planner planner(own.param<std::string>("course", "wren"),
                                 own.param<std::string>("configuration", ""),
                                 own.param<std::string>("method", "svg_mppi"));
  const double most_age = own.param("timeout", 0.15);  // s
  sensor_msgs::LaserScan::ConstPtr scan;
  nav_msgs::Odometry::ConstPtr pose;
  ros::Time used(0);
  const auto drive_out = node.advertise<ackermann_msgs::AckermannDriveStamped>("drive", 1);
  const auto send = [&](double steer, double speed) {
    ackermann_msgs::AckermannDriveStamped m;
    m.header.stamp = ros::Time::now();
    m.header.frame_id = "base_link";
    m.drive.steering_angle = static_cast<float>(steer);
    m.drive.speed = static_cast<float>(speed);
    drive_out.publish(m);
  };
  double last_steer = 0;
  const auto stop = [&](const std::string& why) {
    say(why);
    send(last_steer, 0);
  };
  const auto pose_in = node.subscribe<nav_msgs::Odometry>(
      "pf/pose/odom", 1, [&](const nav_msgs::Odometry::ConstPtr& m) { pose = m; }, ros::VoidConstPtr(),
      ros::TransportHints().tcpNoDelay());
  const auto scan_in = node.subscribe<sensor_msgs::LaserScan>(
      "scan", 1, [&](const sensor_msgs::LaserScan::ConstPtr& m) { scan = m; }, ros::VoidConstPtr(),
      ros::TransportHints().tcpNoDelay());

  const auto tick = [&] {
    for (const std::string& why : {fault(scan, "scan", most_age), fault(pose, "pose", most_age)})
      if (!why.empty()) return stop(why);
    if (!count_fits(*scan)) return stop("scan count does not fit its angles");
    if (scan->header.stamp < used) return stop("scan is older than the one before");
    used = scan->header.stamp;
    const auto command = planner.update(scan_of(*scan), pose_of(pose->pose.pose), pose->twist.twist.linear.x);
    if (!command.ok) say(command.why);  // what it commands then brakes
    last_steer = command.steer;
    send(command.steer, command.speed);
  };
  ros::Rate rate(40);
  for (; ros::ok(); rate.sleep()) {
    ros::spinOnce();
    tick();
  }
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
