// Localisation: computes the transform from map to odom, `pf/pose/odom` and `particlecloud` from `scan`,
// `odom` and a map. While the estimate is not reliable the node publishes neither pose nor transform, and the
// planner stops.
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/transform_listener.h>

#include <deque>

#include <ros/callback_queue.h>

#include "bridge/pose_trust.hpp"
#include "conversions.hpp"
#include "diagnostics.hpp"
#include "parameters.hpp"

namespace slalom_ros {
namespace {

using nav_msgs::Odometry;
using slalom_bridge::Estimate;

const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();

class LocaliserNode {
 public:
  LocaliserNode()
      : own_("~"), watch_({}, ros_clocks()), listener_(buffer_, true, at_once), diagnostics_(node_) {
    tolerance_ = own_.param("transform_tolerance", tolerance_);
    trust_ = slalom_bridge::PoseTrust(own_.param("trust_scans", 10), own_.param("trust_health", 0.7));
    base_ = own_.param<std::string>("base_frame", "base_link");
    localiser_.change(parameters_set(own_, localiser_.options()));
    parameters_ = std::make_unique<DynamicParameters>(
        own_, [this] { return localiser_.options(); },
        [this](const slalom_bridge::Changes& changes) { localiser_.change(changes); });
    pose_out_ = node_.advertise<Odometry>("pf/pose/odom", 1);
    cloud_out_ = node_.advertise<geometry_msgs::PoseArray>("particlecloud", 1);
    tf_out_ = node_.advertise<tf2_msgs::TFMessage>("/tf", 10);
    map_out_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
    const auto course = own_.param<std::string>("course", "");
    if (!course.empty()) {
      const auto loaded = slalom_bridge::load_course(course);
      start_ = loaded.start;
      localiser_.use_map(loaded.map);
      map_out_.publish(message_of(loaded.map));
      begin();
    } else {
      map_out_.shutdown();
      map_in_ = node_.subscribe("map", 1, &LocaliserNode::hear_map, this);
    }
    odometry_in_ = node_.subscribe("odom", 10, &LocaliserNode::hear_odometry, this, at_once);
    scan_in_ = node_.subscribe("scan", 5, &LocaliserNode::hear_scan, this, at_once);
    start_in_ = node_.subscribe("initialpose", 1, &LocaliserNode::hear_start, this);
  }

  void spin() {
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.002));
      if (!watch_.clock_runs()) {
        buffer_.clear();
        odometry_.clear();
        last_scan_ = ros::Time(0);
        if (known_) localiser_.start_at(*known_);
        log_(watch_.fault());
      }
      log_.flush();
      if (diagnostics_.due()) report();
    }
  }

 private:
  /// Starts at the last pose of an earlier node unless the launch file says otherwise; otherwise everywhere.
  void begin() {
    Pose p;
    if (known_) return localiser_.start_at(*known_);
    if (own_.param("everywhere", false)) return localiser_.start_everywhere();
    const bool told = own_.getParam("initial_pose/x", p.x) && own_.getParam("initial_pose/y", p.y) &&
                      own_.getParam("initial_pose/yaw", p.yaw);
    if (told)
      localiser_.start_at(p);
    else if (start_)
      localiser_.start_at(*start_);
    else
      localiser_.start_everywhere();
  }

  void hear_map(const nav_msgs::OccupancyGrid::ConstPtr& m) {
    try {
      localiser_.use_map(grid_of(*m));
      begin();
      ROS_INFO_STREAM("a map of " << m->info.width << " x " << m->info.height << " cells");
    } catch (const std::exception& error) {
      log_(std::string("map: ") + error.what());
    }
  }
  void hear_start(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& m) {
    localiser_.start_at(pose_of(m->pose.pose));
  }
  void hear_odometry(const Odometry::ConstPtr& m) {
    if (!watch_.accepts("odometry", m->header.stamp.toSec(),
                        odometry_.empty() ? 0 : odometry_.back()->header.stamp.toSec()))
      return log_("localisation: " + watch_.fault());
    odometry_.push_back(m);
    if (odometry_.size() > 50) odometry_.pop_front();
  }
  void hear_scan(const sensor_msgs::LaserScan::ConstPtr& scan) {
    if (!watch_.accepts("scan", scan->header.stamp.toSec(), last_scan_.toSec()))
      return log_("localisation: " + watch_.fault());
    last_scan_ = scan->header.stamp;
    Pose at;
    if (!odometry_at(scan->header.stamp, at))
      return log_("localisation: no odometry at the time of the scan");
    place_laser(scan->header.frame_id);
    slalom_bridge::Scan plain = scan_of(*scan);
    if (!count_fits(*scan)) plain.count = 0;
    estimate_ = localiser_.update(plain, at, scan->header.stamp.toSec());
    slowest_ = std::max(slowest_, estimate_.update_time);
    if (!trust_.update(estimate_))
      return log_("localisation: " + trust_.doubt() + ", health " + std::to_string(estimate_.health));
    known_ = estimate_.pose;
    publish(*scan);
  }

  /// The odometry at the time of the scan: interpolated between messages, extrapolated by speed after the
  /// last.
  bool odometry_at(ros::Time stamp, Pose& pose) const {
    if (odometry_.empty()) return false;
    std::size_t after = 0;
    while (after < odometry_.size() && odometry_[after]->header.stamp < stamp) ++after;
    if (after == 0 && odometry_[0]->header.stamp != stamp) return false;
    const auto& last = *odometry_[std::min(after, odometry_.size() - 1)];
    pose = pose_of(last.pose.pose);
    const double ahead = (stamp - last.header.stamp).toSec();
    if (after == odometry_.size()) {
      if (ahead > 0.1) return false;
      const auto& v = last.twist.twist;
      pose.x += v.linear.x * ahead * std::cos(pose.yaw + 0.5 * v.angular.z * ahead);
      pose.y += v.linear.x * ahead * std::sin(pose.yaw + 0.5 * v.angular.z * ahead);
      pose.yaw += v.angular.z * ahead;
    } else if (ahead < 0) {
      const auto& before = *odometry_[after - 1];
      const Pose from = pose_of(before.pose.pose);
      const double share =
          (stamp - before.header.stamp).toSec() / (last.header.stamp - before.header.stamp).toSec();
      pose = {from.x + share * (pose.x - from.x), from.y + share * (pose.y - from.y),
              from.yaw + share * std::remainder(pose.yaw - from.yaw, 6.283185307179586)};
    }
    return true;
  }

  void place_laser(const std::string& frame) {
    try {
      const Pose laser = pose_of(buffer_.lookupTransform(base_, frame, ros::Time(0)).transform);
      const Pose known = localiser_.laser();
      if (std::hypot(laser.x - known.x, laser.y - known.y) < 0.005 &&
          angle_between(laser.yaw, known.yaw) < 0.005)
        return;
      localiser_.change({{"laser_x", std::to_string(laser.x)},
                         {"laser_y", std::to_string(laser.y)},
                         {"laser_yaw", std::to_string(laser.yaw)}});
    } catch (const tf2::TransformException& error) {
      log_(std::string("localisation: uses the pose of the laser in the parameters; tf: ") + error.what());
    }
  }

  void publish(const sensor_msgs::LaserScan& scan) {
    const Odometry& last = *odometry_.back();
    Odometry out = last;
    out.header.stamp = scan.header.stamp;
    out.header.frame_id = "map";
    out.child_frame_id = base_;
    out.pose.pose = message_of(estimate_.pose);
    const int row[3] = {0, 1, 5};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        out.pose.covariance[static_cast<std::size_t>(6 * row[i] + row[j])] = estimate_.covariance[i][j];
    pose_out_.publish(out);
    tf2_msgs::TFMessage tf;
    // Stamped in the future, so that it is valid until the next scan has been processed.
    tf.transforms.push_back(transform(estimate_.odometry_frame, "map", last.header.frame_id,
                                      scan.header.stamp + ros::Duration(tolerance_)));
    tf_out_.publish(tf);
  }

  void report() {
    diagnostics_.add("status", estimate_.status);
    diagnostics_.add("health", estimate_.health);
    diagnostics_.add("fraction of beams explained", estimate_.fit);
    diagnostics_.add("fraction of weight in one cluster", estimate_.share);
    diagnostics_.add("effective sample size", estimate_.effective_samples);
    diagnostics_.add("particles", estimate_.particles);
    diagnostics_.add("slowest update, ms", 1e3 * slowest_);
    const bool seen = !last_scan_.isZero() && (ros::Time::now() - last_scan_).toSec() < 1;
    const std::string what = !localiser_.has_map() ? "no map" : !seen ? "no scans" : estimate_.status;
    diagnostics_.send(seen && trust_.holds() ? 0 : 2, what, "localisation");
    slowest_ = 0;
    if (known_ && trust_.holds()) {  // for a node that is restarted
      own_.setParam("initial_pose/x", known_->x);
      own_.setParam("initial_pose/y", known_->y);
      own_.setParam("initial_pose/yaw", known_->yaw);
    }
    geometry_msgs::PoseArray cloud;
    cloud.header.frame_id = "map";
    cloud.header.stamp = ros::Time::now();
    if (cloud_out_.getNumSubscribers() > 0)
      for (const Pose& p : localiser_.particles(300)) cloud.poses.push_back(message_of(p));
    cloud_out_.publish(cloud);
  }

  ros::NodeHandle node_, own_;
  slalom_bridge::Localiser localiser_;
  slalom_bridge::InputWatch watch_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  Diagnostics diagnostics_;
  std::unique_ptr<DynamicParameters> parameters_;
  std::string base_;
  double tolerance_ = 0.1;  // s
  slalom_bridge::PoseTrust trust_;
  ros::Publisher pose_out_, cloud_out_, tf_out_, map_out_;
  ros::Subscriber map_in_, odometry_in_, scan_in_, start_in_;
  std::deque<Odometry::ConstPtr> odometry_;
  ros::Time last_scan_{0};
  std::optional<Pose> start_, known_;
  Estimate estimate_;
  double slowest_ = 0;
  ThrottledLog log_;
};

}  // namespace
}  // namespace slalom_ros

int main(int argc, char** argv) try {
  ros::init(argc, argv, "localiser");
  slalom_ros::LocaliserNode().spin();
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
