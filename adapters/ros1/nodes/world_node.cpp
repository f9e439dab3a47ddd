// The simulator as a car: listens to `drive`, sends `scan`, `odom` (wheel odometry) and `ground_truth`,
// `laps` and `contacts` (bodies touched). A car that has heard no finite command for 0.2 s brakes, as the
// vehicle side of a real one must.
#include <ackermann_msgs/AckermannDriveStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Int32.h>
#include <std_srvs/Empty.h>

#include "ros_forms.hpp"

using namespace slalom_ros;

int main(int argc, char** argv) try {
  ros::init(argc, argv, "world");
  ros::NodeHandle node, own("~");
  slalom_bridge::World world(own.param<std::string>("course", "wren"),
                             static_cast<std::uint64_t>(own.param("seed", 1)), own.param("obstacles", 5));
  const double timeout = own.param("command_timeout", 0.2);  // s
  double steer = 0, speed = 0;
  ros::Time heard(0);

  const auto scan_out = node.advertise<sensor_msgs::LaserScan>("scan", 1);
  const auto odometry_out = node.advertise<nav_msgs::Odometry>("odom", 1);
  const auto truth_out = node.advertise<nav_msgs::Odometry>("ground_truth", 1);
  const auto laps_out = node.advertise<std_msgs::Int32>("laps", 1);
  const auto contacts_out = node.advertise<std_msgs::Int32>("contacts", 1);
  const auto drive_in = node.subscribe<ackermann_msgs::AckermannDriveStamped>(
      "drive", 1, [&](const ackermann_msgs::AckermannDriveStamped::ConstPtr& m) {
        if (!std::isfinite(m->drive.steering_angle) || !std::isfinite(m->drive.speed)) return;
        steer = m->drive.steering_angle;
        speed = m->drive.speed;
        heard = ros::Time::now();
      });
  const auto reset = node.advertiseService<std_srvs::Empty::Request, std_srvs::Empty::Response>(
      "reset", [&](std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
        world.reset();
        return true;
      });

  const auto odometry = [](const slalom_bridge::Pose& p, double v, double turn, const char* frame) {
    nav_msgs::Odometry m;
    m.header.stamp = ros::Time::now();
    m.header.frame_id = frame;
    m.child_frame_id = "base_link";
    m.pose.pose.position.x = p.x;
    m.pose.pose.position.y = p.y;
    m.pose.pose.orientation = quaternion(p.yaw);
    m.twist.twist.linear.x = v;
    m.twist.twist.angular.z = turn;
    return m;
  };
  ros::Rate rate(40);
  for (; ros::ok(); rate.sleep()) {
    ros::spinOnce();
    const bool late = (ros::Time::now() - heard).toSec() > timeout;
    world.step(steer, late ? 0 : speed);
    const auto& seen = world.reading();
    const auto odom = odometry(seen.odometry, seen.speed, seen.yaw_rate, "odom");
    const auto truth = odometry(seen.truth, seen.speed, seen.yaw_rate, "map");
    std_msgs::Int32 laps, contacts;
    laps.data = seen.laps;
    contacts.data = seen.contacts;
    sensor_msgs::LaserScan scan;
    scan.header.stamp = odom.header.stamp;
    scan.header.frame_id = "laser";
    scan.angle_min = static_cast<float>(seen.angle_min);
    scan.angle_increment = static_cast<float>(seen.angle_increment);
    scan.angle_max = static_cast<float>(seen.angle_min + seen.angle_increment * (seen.ranges.size() - 1));
    scan.range_min = 0.02F;
    scan.range_max = static_cast<float>(seen.range_max);
    scan.ranges = seen.ranges;
    odometry_out.publish(odom);
    truth_out.publish(truth);
    laps_out.publish(laps);
    contacts_out.publish(contacts);
    scan_out.publish(scan);
  }
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
