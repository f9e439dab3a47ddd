// The simulator as a car: subscribes to `drive` and publishes `scan`, `odom` (wheel odometry) with its
// transforms, `map`, `reference_waypoint`, the parked cars, and the true state as `ground_truth`, `laps` and
// `contacts` (number of collisions). Like a real car it must brake without a finite command for 0.2 s, or
// when two nodes command it.
#include <ackermann_msgs/AckermannDriveStamped.h>
#include <nav_msgs/Odometry.h>
#include <std_msgs/Int32.h>
#include <std_srvs/Empty.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>
#include <waypoint_msg/Waypoint.h>

#include <ros/callback_queue.h>

#include "bridge/world_core.hpp"
#include "conversions.hpp"

namespace slalom_ros1 {
namespace {

using Drive = ackermann_msgs::AckermannDriveStamped;

const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();

slalom_bridge::WorldCore::Settings settings_from(ros::NodeHandle& own) {
  slalom_bridge::WorldCore::Settings s;
  s.course = own.param<std::string>("course", s.course);
  s.seed = static_cast<std::uint64_t>(own.param("seed", 1));
  s.obstacles = own.param("obstacles", s.obstacles);
  s.command_timeout = own.param("command_timeout", s.command_timeout);
  return s;
}

nav_msgs::Odometry odometry(const Pose& p, const slalom_bridge::World::Reading& seen, const char* frame,
                            ros::Time stamp) {
  nav_msgs::Odometry m;
  m.header.stamp = stamp;
  m.header.frame_id = frame;
  m.child_frame_id = "base_link";
  m.pose.pose = message_of(p);
  m.twist.twist.linear.x = seen.speed;
  m.twist.twist.angular.z = seen.yaw_rate;
  return m;
}

visualization_msgs::Marker box(int id, const char* frame, const Pose& pose, double length, double width) {
  visualization_msgs::Marker m;
  m.header.frame_id = frame;
  m.ns = frame;
  m.id = id;
  m.type = visualization_msgs::Marker::CUBE;
  m.pose = message_of(pose);
  m.pose.position.z = 0.1;
  m.scale.x = length;
  m.scale.y = width;
  m.scale.z = 0.2;
  m.color.a = 0.8F;
  return m;
}

class WorldNode {
 public:
  WorldNode() : own_("~"), core_(settings_from(own_), ros_clocks(), warn) {
    scan_out_ = node_.advertise<sensor_msgs::LaserScan>("scan", 1);
    odometry_out_ = node_.advertise<nav_msgs::Odometry>("odom", 1);
    truth_out_ = node_.advertise<nav_msgs::Odometry>("ground_truth", 1);
    laps_out_ = node_.advertise<std_msgs::Int32>("laps", 1);
    contacts_out_ = node_.advertise<std_msgs::Int32>("contacts", 1);
    tf_out_ = node_.advertise<tf2_msgs::TFMessage>("/tf", 10);
    tf_static_out_ = node_.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
    map_out_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
    waypoints_out_ = node_.advertise<waypoint_msg::Waypoint>("reference_waypoint", 1, true);
    markers_out_ = node_.advertise<visualization_msgs::MarkerArray>("obstacles", 1, true);
    drive_in_ = node_.subscribe("drive", 10, &WorldNode::hear_drive, this, at_once);
    reset_in_ = node_.advertiseService("reset", &WorldNode::reset, this);
    describe();
  }

  void spin() {
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.001));
      slalom_bridge::Stamp stamp = 0;
      if (core_.step_if_due(stamp)) publish(time_of(stamp));
    }
  }

 private:
  void hear_drive(const ros::MessageEvent<Drive const>& event) {
    const auto& drive = event.getMessage()->drive;
    core_.hear_drive(event.getPublisherName(), static_cast<double>(drive.steering_angle),
                     static_cast<double>(drive.speed));
  }
  bool reset(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
    core_.reset();
    return true;
  }

  /// Publishes what does not change: map, path, pose of the laser.
  void describe() {
    const auto& course = core_.course();
    map_out_.publish(message_of(course.map));
    waypoint_msg::Waypoint path;
    path.header.frame_id = "map";
    path.header.stamp = ros::Time::now();
    for (const auto& w : course.waypoints) {
      geometry_msgs::PoseStamped p;
      geometry_msgs::TwistStamped t;
      p.header = t.header = path.header;
      p.pose = message_of(Pose{w.x, w.y, w.yaw});
      t.twist.linear.x = w.speed;
      path.poses.push_back(p);
      path.twists.push_back(t);
    }
    waypoints_out_.publish(path);
    tf2_msgs::TFMessage tf;
    tf.transforms.push_back(transform(core_.world().laser(), "base_link", "laser", ros::Time::now()));
    tf_static_out_.publish(tf);
  }

  /// Publishes obstacles and car.
  void mark() {
    const slalom_bridge::World& world = core_.world();
    visualization_msgs::MarkerArray array;
    for (const Pose& p : world.obstacles()) {
      array.markers.push_back(
          box(static_cast<int>(array.markers.size()), "map", p, world.car_length(), world.car_width()));
      array.markers.back().color.r = 0.9F;
    }
    array.markers.push_back(box(0, "base_link", {0.17145, 0, 0}, world.car_length(), world.car_width()));
    array.markers.back().color.g = 0.6F;
    array.markers.back().frame_locked = true;
    markers_out_.publish(array);
  }

  void publish(ros::Time stamp) {
    if (core_.marks_due()) mark();
    const auto& seen = core_.world().reading();
    odometry_out_.publish(odometry(seen.odometry, seen, "odom", stamp));
    truth_out_.publish(odometry(seen.truth, seen, "map", stamp));
    tf2_msgs::TFMessage tf;
    tf.transforms.push_back(transform(seen.odometry, "odom", "base_link", stamp));
    tf_out_.publish(tf);
    std_msgs::Int32 laps, contacts;
    laps.data = seen.laps;
    contacts.data = seen.contacts;
    laps_out_.publish(laps);
    contacts_out_.publish(contacts);
    sensor_msgs::LaserScan scan;
    scan.header.stamp = stamp;
    scan.header.frame_id = "laser";
    scan.angle_min = static_cast<float>(seen.angle_min);
    scan.angle_increment = static_cast<float>(seen.angle_increment);
    scan.angle_max = static_cast<float>(seen.angle_min + seen.angle_increment * (seen.ranges.size() - 1));
    scan.range_min = 0.02F;
    scan.range_max = static_cast<float>(seen.range_max);
    scan.ranges = seen.ranges;
    scan_out_.publish(scan);
  }

  ros::NodeHandle node_, own_;
  slalom_bridge::WorldCore core_;
  ros::Publisher scan_out_, odometry_out_, truth_out_, laps_out_, contacts_out_, tf_out_, tf_static_out_,
      map_out_, waypoints_out_, markers_out_;
  ros::Subscriber drive_in_;
  ros::ServiceServer reset_in_;
};

}  // namespace
}  // namespace slalom_ros1

int main(int argc, char** argv) try {
  ros::init(argc, argv, "world");
  slalom_ros1::WorldNode().spin();
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
