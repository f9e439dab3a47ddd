// The controller: computes `drive` from `scan`, `odom` and tf, with a new plan for every scan. The core of
// the bridge does the work. docs/on-the-car.md has topics, frames, parameters and faults.
#include <ackermann_msgs/AckermannDriveStamped.h>
#include <mppi_metrics_msgs/MPPIMetrics.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/Imu.h>
#include <std_msgs/Float32.h>
#include <tf2_ros/transform_listener.h>
#include <visualization_msgs/MarkerArray.h>
#include <waypoint_msg/Waypoint.h>

#include <ros/callback_queue.h>

#include "bridge/planner_core.hpp"
#include "conversions.hpp"
#include "diagnostics.hpp"
#include "parameters.hpp"

namespace slalom_ros1 {
namespace {

using slalom_bridge::Command;
using slalom_bridge::PlannerCore;
using slalom_bridge::Stamp;
using slalom_bridge::Waypoint;
using Drive = ackermann_msgs::AckermannDriveStamped;

const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();

PlannerCore::Settings settings_from(ros::NodeHandle& own) {
  PlannerCore::Settings s;
  s.configuration = own.param<std::string>("configuration", s.configuration);
  s.method = own.param<std::string>("method", s.method);
  s.course = own.param<std::string>("course", s.course);
  s.limits.max_age = own.param("timeout", s.limits.max_age);
  s.limits.settle_time = own.param("settle_time", s.limits.settle_time);
  return s;
}

class PlannerNode {
 public:
  PlannerNode()
      : own_("~"),
        base_(own_.param<std::string>("base_frame", "base_link")),
        map_(own_.param<std::string>("map_frame", "map")),
        listener_(buffer_, true, at_once),
        diagnostics_(node_),
        drive_out_(node_.advertise<Drive>("drive", 1)),
        metrics_out_(node_.advertise<mppi_metrics_msgs::MPPIMetrics>("mppi/eval_metrics", 1)),
        markers_out_(node_.advertise<visualization_msgs::MarkerArray>("planner_markers", 1)),
        path_out_(node_.advertise<nav_msgs::Path>("reference_path", 1, true)),
        core_(settings_from(own_), ros_clocks(), frames_of(buffer_, map_, base_),
              {[this](double steer, double speed) { send(steer, speed); },
               [this](const Command& command, Stamp scan) { show(command, time_of(scan)); },
               [this](const std::vector<Waypoint>& path, bool closed) { show_path(path, closed); }, warn,
               inform}) {
    core_.change(parameters_set(own_, core_.options()));
    core_.use_course();
    parameters_ = std::make_unique<DynamicParameters>(
        own_, [this] { return core_.options(); },
        [this](const slalom_bridge::Changes& changes) { core_.change(changes); });
    scan_in_ = node_.subscribe("scan", 5, &PlannerNode::hear_scan, this, at_once);
    odometry_in_ = node_.subscribe("odom", 5, &PlannerNode::hear_odometry, this, at_once);
    imu_in_ = node_.subscribe("imu", 50, &PlannerNode::hear_imu, this, at_once);
    drive_in_ = node_.subscribe("drive", 10, &PlannerNode::hear_drive, this, at_once);
    goal_in_ = node_.subscribe("goal_speed", 1, &PlannerNode::hear_goal_speed, this);
    if (own_.param<std::string>("course", "").empty())
      waypoints_in_ = node_.subscribe("reference_waypoint", 1, &PlannerNode::hear_waypoints, this);
  }

  void spin() {
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.002));
      core_.tick();
      if (diagnostics_.due()) diagnostics_.send(core_.report());
    }
  }

 private:
  void hear_scan(const sensor_msgs::LaserScan::ConstPtr& m) {
    core_.hear_scan(stamp_of(m->header.stamp), m->header.frame_id, scan_of(*m), m->angle_max);
  }
  void hear_odometry(const nav_msgs::Odometry::ConstPtr& m) {
    core_.hear_odometry(stamp_of(m->header.stamp), m->twist.twist.linear.x);
  }
  void hear_imu(const sensor_msgs::Imu::ConstPtr& m) {
    const auto &turn = m->angular_velocity, &acceleration = m->linear_acceleration;
    core_.hear_imu(
        {m->header.frame_id, {turn.x, turn.y, turn.z}, {acceleration.x, acceleration.y, acceleration.z}});
  }
  void hear_drive(const ros::MessageEvent<Drive const>& event) {
    if (event.getPublisherName() != ros::this_node::getName())
      core_.hear_other_command(event.getPublisherName());
  }
  void hear_goal_speed(const std_msgs::Float32::ConstPtr& m) {
    core_.hear_goal_speed(static_cast<double>(m->data));
  }
  void hear_waypoints(const waypoint_msg::Waypoint::ConstPtr& m) {
    if (m->twists.size() != m->poses.size())
      return warn("waypoints: the numbers of poses and speeds differ; ignored");
    std::vector<Waypoint> path;
    for (std::size_t i = 0; i < m->poses.size(); ++i) {
      const Pose p = pose_of(m->poses[i].pose);
      path.push_back({p.x, p.y, p.yaw, m->twists[i].twist.linear.x});
    }
    core_.hear_path(path);
  }

  void send(double steer, double speed) {
    Drive m;
    m.header.stamp = ros::Time::now();
    m.header.frame_id = base_;
    m.drive.steering_angle = static_cast<float>(steer);
    m.drive.speed = static_cast<float>(speed);
    drive_out_.publish(m);
  }

  void show_path(const std::vector<Waypoint>& path, bool closed) {
    nav_msgs::Path m;
    m.header.frame_id = map_;
    m.header.stamp = ros::Time::now();
    for (const auto& w : path) {
      geometry_msgs::PoseStamped p;
      p.header = m.header;
      p.pose = message_of(Pose{w.x, w.y, w.yaw});
      m.poses.push_back(p);
    }
    if (closed) m.poses.push_back(m.poses.front());
    path_out_.publish(m);
  }

  void show(const Command& command, ros::Time scan) {
    mppi_metrics_msgs::MPPIMetrics metrics;
    metrics.header.stamp = scan;
    metrics.state_cost = static_cast<float>(command.state_cost);
    metrics.collision_cost = static_cast<float>(command.collision_cost);
    metrics.input_error = static_cast<float>(command.input_error);
    metrics.calculation_time = static_cast<float>(1e3 * command.update_time);
    metrics_out_.publish(metrics);
    if (markers_out_.getNumSubscribers() == 0) return;
    visualization_msgs::MarkerArray array;
    visualization_msgs::Marker line;
    line.header.stamp = scan;
    line.header.frame_id = map_;
    line.ns = "plan";
    line.type = visualization_msgs::Marker::LINE_STRIP;
    line.pose.orientation.w = 1;
    line.scale.x = 0.06;
    line.color.a = 1;
    line.color.r = command.ok ? 0.1F : 0.9F;
    line.color.g = command.ok ? 0.5F : 0.1F;
    line.color.b = command.ok ? 0.9F : 0.1F;
    for (const Pose& p : core_.predicted()) {
      line.points.emplace_back();
      line.points.back().x = p.x;
      line.points.back().y = p.y;
      line.points.back().z = 0.05;
    }
    line.action = line.points.empty() ? 2 : 0;  // DELETE : ADD
    array.markers.push_back(line);
    markers_out_.publish(array);
  }

  ros::NodeHandle node_, own_;
  std::string base_, map_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  Diagnostics diagnostics_;
  ros::Publisher drive_out_, metrics_out_, markers_out_, path_out_;
  PlannerCore core_;
  std::unique_ptr<DynamicParameters> parameters_;
  ros::Subscriber scan_in_, odometry_in_, imu_in_, drive_in_, goal_in_, waypoints_in_;
};

}  // namespace
}  // namespace slalom_ros1

int main(int argc, char** argv) try {
  ros::init(argc, argv, "planner");
  slalom_ros1::PlannerNode().spin();
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
