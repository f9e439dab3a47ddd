// Where the car is: listens to `scan` and `odom`, sends `pf/pose/odom` (map frame) and the transform from map
// to odom. While the guess is not to be trusted it sends nothing, and the planner stops for want of a pose.
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include "ros_forms.hpp"

using namespace slalom_ros;

int main(int argc, char** argv) try {
  ros::init(argc, argv, "localiser");
  ros::NodeHandle node, own("~");
  slalom_bridge::Localiser localiser(own.param<std::string>("course", "wren"), own.param("everywhere", false),
                                     static_cast<std::uint64_t>(own.param("seed", 1)));
  nav_msgs::Odometry::ConstPtr odometry;
  const auto pose_out = node.advertise<nav_msgs::Odometry>("pf/pose/odom", 1);
  const auto tf_out = node.advertise<tf2_msgs::TFMessage>("tf", 1);
  const auto odometry_in = node.subscribe<nav_msgs::Odometry>(
      "odom", 1, [&](const nav_msgs::Odometry::ConstPtr& m) { odometry = m; }, ros::VoidConstPtr(),
      ros::TransportHints().tcpNoDelay());
  const auto start_in = node.subscribe<geometry_msgs::PoseWithCovarianceStamped>(
      "initialpose", 1, [&](const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& m) {
        localiser.start_at(pose_of(m->pose.pose));
      });
  const auto scan_in = node.subscribe<sensor_msgs::LaserScan>(
      "scan", 1,
      [&](const sensor_msgs::LaserScan::ConstPtr& scan) {
        if (!odometry) return say("no odometry yet");
        if (std::abs((scan->header.stamp - odometry->header.stamp).toSec()) > 0.1)
          return say("odometry and scan are more than 0.1 s apart");
        slalom_bridge::Scan plain = scan_of(*scan);
        if (!count_fits(*scan)) plain.count = 0;
        const auto e = localiser.update(plain, pose_of(odometry->pose.pose), scan->header.stamp.toSec());
        if (!e.usable) {
          ROS_WARN_STREAM_THROTTLE(1.0, "localisation: " << e.status << ", health " << e.health);
          return;
        }
        nav_msgs::Odometry out = *odometry;
        out.header.stamp = scan->header.stamp;
        out.header.frame_id = "map";
        out.pose.pose.position.x = e.pose.x;
        out.pose.pose.position.y = e.pose.y;
        out.pose.pose.orientation = quaternion(e.pose.yaw);
        const int row[3] = {0, 1, 5};
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            out.pose.covariance[static_cast<std::size_t>(6 * row[i] + row[j])] = e.covariance[i][j];
        pose_out.publish(out);
        tf2_msgs::TFMessage tf;
        tf.transforms.resize(1);
        tf.transforms[0].header = out.header;
        tf.transforms[0].child_frame_id = "odom";
        tf.transforms[0].transform.translation.x = e.odometry_frame.x;
        tf.transforms[0].transform.translation.y = e.odometry_frame.y;
        tf.transforms[0].transform.rotation = quaternion(e.odometry_frame.yaw);
        tf_out.publish(tf);
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
