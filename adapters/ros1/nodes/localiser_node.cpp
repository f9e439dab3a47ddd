// Localisation: computes the transform from map to odom, `pf/pose/odom` and `particlecloud` from `scan`,
// `odom` and a map. The core of the bridge does the work. docs/on-the-car.md has topics, frames, parameters
// and faults.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/transform_listener.h>

#include <ros/callback_queue.h>

#include "bridge/localiser_core.hpp"
#include "conversions.hpp"
#include "diagnostics.hpp"
#include "parameters.hpp"

namespace slalom_ros1 {
namespace {

using nav_msgs::Odometry;
using slalom_bridge::Estimate;
using slalom_bridge::LocaliserCore;
using slalom_bridge::Stamp;

const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();

/// The parameter from which a node continues that is restarted.
const std::string kept_place = "kept_place";

/// Starts where an earlier node was, if that was no more than 10 s ago; otherwise as the launch file says.
LocaliserCore::Settings settings_from(ros::NodeHandle& own) {
  LocaliserCore::Settings s;
  s.course = own.param<std::string>("course", s.course);
  s.everywhere = own.param("everywhere", s.everywhere);
  s.trust_scans = own.param("trust_scans", s.trust_scans);
  s.trust_health = own.param("trust_health", s.trust_health);
  s.transform_tolerance = own.param("transform_tolerance", s.transform_tolerance);
  Pose p;
  if (own.getParam("initial_pose/x", p.x) && own.getParam("initial_pose/y", p.y) &&
      own.getParam("initial_pose/yaw", p.yaw))
    s.start = p;
  std::vector<double> kept;
  slalom_bridge::KnownPlaceNumbers numbers;
  if (own.getParam(kept_place, kept) && kept.size() == numbers.size()) {
    std::copy(kept.begin(), kept.end(), numbers.begin());
    s.earlier = slalom_bridge::recent_place(numbers, ros::WallTime::now().toSec());
  }
  return s;
}

class LocaliserNode {
 public:
  LocaliserNode()
      : own_("~"),
        base_(own_.param<std::string>("base_frame", "base_link")),
        listener_(buffer_, true, at_once),
        diagnostics_(node_),
        pose_out_(node_.advertise<Odometry>("pf/pose/odom", 1)),
        cloud_out_(node_.advertise<geometry_msgs::PoseArray>("particlecloud", 1)),
        tf_out_(node_.advertise<tf2_msgs::TFMessage>("/tf", 10)),
        core_(settings_from(own_), ros_clocks(), frames_of(buffer_, "map", base_),
              {[this](const Pose& base, const Estimate& estimate, Stamp scan) {
                 publish(base, estimate, time_of(scan));
               },
               [this](const Pose& odometry_frame, Stamp stamp) {
                 tf2_msgs::TFMessage tf;
                 tf.transforms.push_back(
                     transform(odometry_frame, "map", odometry_.header.frame_id, time_of(stamp)));
                 tf_out_.publish(tf);
               },
               [this](const slalom_bridge::Grid& map) {
                 map_out_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
                 map_out_.publish(message_of(map));
               },
               warn, inform}) {
    core_.change(parameters_set(own_, core_.options()));
    core_.use_course();
    parameters_ = std::make_unique<DynamicParameters>(
        own_, [this] { return core_.options(); },
        [this](const slalom_bridge::Changes& changes) { core_.change(changes); });
    if (own_.param<std::string>("course", "").empty())
      map_in_ = node_.subscribe("map", 1, &LocaliserNode::hear_map, this);
    odometry_in_ = node_.subscribe("odom", 10, &LocaliserNode::hear_odometry, this, at_once);
    scan_in_ = node_.subscribe("scan", 5, &LocaliserNode::hear_scan, this, at_once);
    start_in_ = node_.subscribe("initialpose", 1, &LocaliserNode::hear_start, this);
  }

  void spin() {
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.002));
      core_.tick();
      if (diagnostics_.due()) report();
    }
  }

 private:
  void hear_map(const nav_msgs::OccupancyGrid::ConstPtr& m) { core_.hear_map(grid_of(*m)); }
  void hear_start(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& m) {
    core_.hear_start(pose_of(m->pose.pose));
  }
  void hear_odometry(const Odometry::ConstPtr& m) {
    odometry_ = *m;
    core_.hear_odometry({stamp_of(m->header.stamp), pose_of(m->pose.pose), m->twist.twist.linear.x,
                         m->twist.twist.angular.z});
  }
  void hear_scan(const sensor_msgs::LaserScan::ConstPtr& m) {
    core_.hear_scan(stamp_of(m->header.stamp), m->header.frame_id, scan_of(*m), m->angle_max);
  }

  void publish(const Pose& base, const Estimate& estimate, ros::Time scan) {
    Odometry out = odometry_;
    out.header.stamp = scan;
    out.header.frame_id = "map";
    out.child_frame_id = base_;
    out.pose.pose = message_of(base);
    const int row[3] = {0, 1, 5};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        out.pose.covariance[static_cast<std::size_t>(6 * row[i] + row[j])] = estimate.covariance[i][j];
    pose_out_.publish(out);
  }

  void report() {
    diagnostics_.send(core_.report());
    if (const auto place = core_.reliable()) {
      const auto numbers = slalom_bridge::numbers_of(*place, ros::WallTime::now().toSec());
      own_.setParam(kept_place, std::vector<double>(numbers.begin(), numbers.end()));
    }
    geometry_msgs::PoseArray cloud;
    cloud.header.frame_id = "map";
    cloud.header.stamp = ros::Time::now();
    if (cloud_out_.getNumSubscribers() > 0)
      for (const Pose& p : core_.particles(300)) cloud.poses.push_back(message_of(p));
    cloud_out_.publish(cloud);
  }

  ros::NodeHandle node_, own_;
  std::string base_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  Diagnostics diagnostics_;
  ros::Publisher pose_out_, cloud_out_, tf_out_, map_out_;
  Odometry odometry_;  ///< the last one
  LocaliserCore core_;
  std::unique_ptr<DynamicParameters> parameters_;
  ros::Subscriber map_in_, odometry_in_, scan_in_, start_in_;
};

}  // namespace
}  // namespace slalom_ros1

int main(int argc, char** argv) try {
  ros::init(argc, argv, "localiser");
  slalom_ros1::LocaliserNode().spin();
} catch (const std::exception& error) {
  ROS_FATAL_STREAM(error.what());
  return 1;
}
