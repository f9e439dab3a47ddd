// The controller: computes `drive` from `scan`, `odom` and tf, with a new plan for every scan. If an input is
// missing, late, out of order, from the future or invalid, it sends speed 0 and reports the reason, and
// continues once the inputs have been valid for a moment. docs/on-the-car.md has topics, frames and
// parameters.
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

#include "conversions.hpp"
#include "diagnostics.hpp"
#include "parameters.hpp"

namespace slalom_ros {
namespace {

using slalom_bridge::Command;
using slalom_bridge::InputWatch;
using slalom_bridge::WatchLimits;
using Drive = ackermann_msgs::AckermannDriveStamped;

const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();

WatchLimits limits_from(ros::NodeHandle& own) {
  WatchLimits l;
  l.max_age = own.param("timeout", l.max_age);
  l.settle_time = own.param("settle_time", l.settle_time);
  return l;
}

/// s, of a message; 0 where there is none.
template <class Message>
double stamp_of(const Message& message) {
  return message ? message->header.stamp.toSec() : 0;
}

/// A path is closed if its end is near its start.
bool is_closed(const std::vector<slalom_bridge::Waypoint>& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y);
  const double gap = std::hypot(path.front().x - path.back().x, path.front().y - path.back().y);
  return gap < 5 * length / static_cast<double>(path.size());
}

/// Statistics since the last report.
struct Second {
  int plans = 0, stops = 0, late = 0, corrections = 0;
  double slowest = 0, min_samples = 1e300;
  std::string why;
};

class PlannerNode {
 public:
  PlannerNode()
      : own_("~"),
        planner_(own_.param<std::string>("configuration", "default"),
                 own_.param<std::string>("method", "svg_mppi")),
        watch_(limits_from(own_), ros_clocks()),
        listener_(buffer_, true, at_once),
        diagnostics_(node_) {
    base_ = own_.param<std::string>("base_frame", "base_link");
    map_ = own_.param<std::string>("map_frame", "map");
    planner_.change(parameters_set(own_, planner_.options()));
    parameters_ = std::make_unique<DynamicParameters>(
        own_, [this] { return planner_.options(); },
        [this](const slalom_bridge::Changes& changes) { planner_.change(changes); });
    drive_out_ = node_.advertise<Drive>("drive", 1);
    metrics_out_ = node_.advertise<mppi_metrics_msgs::MPPIMetrics>("mppi/eval_metrics", 1);
    markers_out_ = node_.advertise<visualization_msgs::MarkerArray>("planner_markers", 1);
    path_out_ = node_.advertise<nav_msgs::Path>("reference_path", 1, true);
    const auto course = own_.param<std::string>("course", "");
    if (!course.empty()) {
      const auto loaded = slalom_bridge::load_course(course);
      use_path(loaded.waypoints, loaded.closed);
    }
    scan_in_ = node_.subscribe("scan", 5, &PlannerNode::hear_scan, this, at_once);
    odometry_in_ = node_.subscribe("odom", 5, &PlannerNode::hear_odometry, this, at_once);
    imu_in_ = node_.subscribe("imu", 50, &PlannerNode::hear_imu, this, at_once);
    drive_in_ = node_.subscribe("drive", 10, &PlannerNode::hear_drive, this, at_once);
    goal_in_ = node_.subscribe("goal_speed", 1, &PlannerNode::hear_goal_speed, this);
    if (course.empty())
      waypoints_in_ = node_.subscribe("reference_waypoint", 1, &PlannerNode::hear_waypoints, this);
  }

  void spin() {
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.002));
      if (!watch_.clock_runs()) start_anew();
      const double idle = ros::SteadyTime::now().toSec() - sent_;
      if (scan_is_due() || idle > 1.6 * planner_.control_period()) tick();
      log_.flush();
      if (diagnostics_.due()) report();
    }
  }

 private:
  /// A scan waits a little for the transforms of its time, which arrive on another topic.
  bool scan_is_due() const {
    if (!new_scan_) return false;
    return ros::SteadyTime::now().toSec() - scan_heard_ > 0.8 * planner_.control_period() ||
           buffer_.canTransform(map_, base_, scan_->header.stamp);
  }

  void start_anew() {
    buffer_.clear();
    scan_.reset();
    odometry_.reset();
    imu_.clear();
    new_scan_ = false;
    watch_.forget();
  }

  void hear_scan(const sensor_msgs::LaserScan::ConstPtr& m) {
    if (!watch_.accepts("scan", m->header.stamp.toSec(), stamp_of(scan_))) return;
    if (!count_fits(*m)) return watch_.report("the number of ranges of the scan does not match its angles");
    scan_ = m;
    scan_heard_ = ros::SteadyTime::now().toSec();
    new_scan_ = true;
  }
  void hear_odometry(const nav_msgs::Odometry::ConstPtr& m) {
    if (!watch_.accepts("odometry", m->header.stamp.toSec(), stamp_of(odometry_))) return;
    if (!std::isfinite(m->twist.twist.linear.x))
      return watch_.report("the speed of the odometry is not finite");
    odometry_ = m;
  }
  /// A unit that is mounted along the axes of the base frame.
  void hear_imu(const sensor_msgs::Imu::ConstPtr& m) {
    imu_.add(m->angular_velocity.z, m->linear_acceleration.x, m->linear_acceleration.y);
  }
  void hear_drive(const ros::MessageEvent<Drive const>& event) {
    if (event.getPublisherName() != ros::this_node::getName())
      watch_.report("another node commands the car: " + event.getPublisherName());
  }
  void hear_goal_speed(const std_msgs::Float32::ConstPtr& m) {
    if (!std::isfinite(m->data)) return log_("goal speed is not finite; ignored");
    stopped_by_goal_ = m->data <= 0;
    if (stopped_by_goal_) return;
    try {
      planner_.change({{"planner/max_speed", std::to_string(std::clamp<double>(m->data, 0.01, 100))}});
    } catch (const std::exception& error) {
      log_(error.what());
    }
  }
  void hear_waypoints(const waypoint_msg::Waypoint::ConstPtr& m) {
    std::vector<slalom_bridge::Waypoint> path;
    const std::size_t count = m->poses.size();
    if (m->twists.size() != count) return log_("waypoints: the numbers of poses and speeds differ; ignored");
    for (std::size_t i = 0; i < count; ++i) {
      const Pose p = pose_of(m->poses[i].pose);
      path.push_back({p.x, p.y, p.yaw, m->twists[i].twist.linear.x});
    }
    try {
      if (count < 3) throw std::invalid_argument("fewer than 3");
      use_path(path, is_closed(path));
    } catch (const std::exception& error) {
      log_(std::string("waypoints: ") + error.what() + "; ignored");
    }
  }

  void use_path(const std::vector<slalom_bridge::Waypoint>& path, bool closed) {
    planner_.use_path(path);
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

  /// The pose of the rear axle at the time of the scan. Returns false and reports the fault if it is unknown.
  bool find_pose(Pose& pose) {
    try {
      const ros::Time stamp = scan_->header.stamp;
      pose = pose_of(buffer_.lookupTransform(map_, base_, stamp).transform);
      place_laser(pose_of(buffer_.lookupTransform(base_, scan_->header.frame_id, ros::Time(0)).transform));
      return watch_.moves_like_a_car(pose, stamp.toSec());
    } catch (const std::exception& error) {
      watch_.report_consequence(std::string("tf: ") + error.what());
      return false;
    }
  }

  void place_laser(const Pose& laser) {
    const Pose known = planner_.laser();
    if (std::hypot(laser.x - known.x, laser.y - known.y) < 0.005 &&
        angle_between(laser.yaw, known.yaw) < 0.005)
      return;
    planner_.change({{"planner/laser_x", std::to_string(laser.x)},
                     {"planner/laser_y", std::to_string(laser.y)},
                     {"planner/laser_yaw", std::to_string(laser.yaw)}});
    ROS_INFO_STREAM("the laser is at x " << laser.x << " m, y " << laser.y << " m, yaw " << laser.yaw
                                         << " rad by tf");
  }

  void tick() {
    const bool scanned = new_scan_;
    new_scan_ = false;
    Pose pose;
    const bool well = planner_.has_path() ? watch_.fresh("scan", stamp_of(scan_)) &&
                                                watch_.fresh("odometry", stamp_of(odometry_))
                                          : (watch_.report_consequence("no waypoints yet"), false);
    const bool placed = well && (!scanned || find_pose(pose));
    const std::string fault = watch_.fault();
    if (!fault.empty()) return stop(fault);
    if (!placed) return stop("input");
    if (stopped_by_goal_) return stop("goal speed is 0");
    if (!scanned) return;  // the scan is slightly late; the last command remains valid
    const Command command = planner_.update(scan_of(*scan_), pose, odometry_->twist.twist.linear.x, imu_);
    imu_.clear();
    known_ = command;
    ++second_.plans;
    second_.late += command.update_time > planner_.control_period();
    second_.slowest = std::max(second_.slowest, command.update_time);
    second_.corrections += command.corrections;
    second_.min_samples = std::min(second_.min_samples, command.effective_samples);
    if (!command.ok) {
      second_.why = command.status;
      log_("braking: " + command.status);
    }
    last_steer_ = command.steer;
    send(command.steer, command.speed);
    show(command);
  }

  void stop(const std::string& why) {
    ++second_.stops;
    second_.why = why;
    log_("stopping: " + why);
    send(last_steer_, 0);
  }

  void send(double steer, double speed) {
    Drive m;
    m.header.stamp = ros::Time::now();
    m.header.frame_id = base_;
    m.drive.steering_angle = static_cast<float>(steer);
    m.drive.speed = static_cast<float>(speed);
    drive_out_.publish(m);
    sent_ = ros::SteadyTime::now().toSec();
  }

  void show(const Command& command) {
    mppi_metrics_msgs::MPPIMetrics metrics;
    metrics.header.stamp = scan_->header.stamp;
    metrics.state_cost = static_cast<float>(command.state_cost);
    metrics.collision_cost = static_cast<float>(command.collision_cost);
    metrics.input_error = static_cast<float>(command.input_error);
    metrics.calculation_time = static_cast<float>(1e3 * command.update_time);
    metrics_out_.publish(metrics);
    if (markers_out_.getNumSubscribers() == 0) return;
    visualization_msgs::MarkerArray array;
    visualization_msgs::Marker line;
    line.header.stamp = scan_->header.stamp;
    line.header.frame_id = map_;
    line.ns = "plan";
    line.type = visualization_msgs::Marker::LINE_STRIP;
    line.pose.orientation.w = 1;
    line.scale.x = 0.06;
    line.color.a = 1;
    line.color.r = command.ok ? 0.1F : 0.9F;
    line.color.g = command.ok ? 0.5F : 0.1F;
    line.color.b = command.ok ? 0.9F : 0.1F;
    for (const Pose& p : planner_.predicted()) {
      line.points.emplace_back();
      line.points.back().x = p.x;
      line.points.back().y = p.y;
      line.points.back().z = 0.05;
    }
    line.action = line.points.empty() ? 2 : 0;  // DELETE : ADD
    array.markers.push_back(line);
    markers_out_.publish(array);
  }

  void report() {
    diagnostics_.add("plans", second_.plans);
    diagnostics_.add("stops", second_.stops);
    diagnostics_.add("deadlines missed", second_.late);
    diagnostics_.add("values corrected", second_.corrections);
    diagnostics_.add("slowest update, ms", 1e3 * second_.slowest);
    diagnostics_.add("deadline, ms", 1e3 * planner_.control_period());
    if (known_.friction > 0) {
      diagnostics_.add("friction", known_.friction);
      diagnostics_.add("friction, standard deviation", known_.friction_deviation);
      diagnostics_.add("friction that plans rely on", known_.cautious_friction);
      diagnostics_.add("confidence of the friction", known_.confidence);
      diagnostics_.add("steering gain", known_.steering_gain);
      diagnostics_.add("steering delay, ms", 1e3 * known_.delay);
      diagnostics_.add("slip angle, rad", known_.slip);
    }
    if (second_.plans > 0) diagnostics_.add("least effective sample size", second_.min_samples);
    const int level = second_.stops > 0 || second_.plans == 0    ? 2
                      : second_.late > 0 || !second_.why.empty() ? 1
                                                                 : 0;
    diagnostics_.send(level, second_.why.empty() ? "driving" : second_.why, "plans");
    second_ = {};
  }

  ros::NodeHandle node_, own_;
  slalom_bridge::Planner planner_;
  InputWatch watch_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  Diagnostics diagnostics_;
  std::unique_ptr<DynamicParameters> parameters_;
  std::string base_, map_;
  ros::Publisher drive_out_, metrics_out_, markers_out_, path_out_;
  ros::Subscriber scan_in_, odometry_in_, imu_in_, drive_in_, goal_in_, waypoints_in_;
  sensor_msgs::LaserScan::ConstPtr scan_;
  nav_msgs::Odometry::ConstPtr odometry_;
  slalom_bridge::ImuSamples imu_;
  Command known_;  ///< of the last plan
  bool new_scan_ = false, stopped_by_goal_ = false;
  double last_steer_ = 0, sent_ = 0, scan_heard_ = 0;
  ThrottledLog log_;
  Second second_;
};

}  // namespace
}  // namespace slalom_ros

int main(int argc, char** argv) try {
  ros::init(argc, argv, "planner");
  slalom_ros::PlannerNode().spin();
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
