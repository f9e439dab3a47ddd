// Localisation: computes the transform from map to odom, `pf/pose/odom` and `particlecloud` from `scan`,
// `odom` and a map. LocaliserCore does the work. docs/on-the-car.md has topics, parameters and faults.
#include <ctime>

#include <geometry_msgs/msg/pose_array.hpp>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <tf2_ros/qos.hpp>

#include "logic/localiser_core.hpp"
#include "managed_node.hpp"

namespace slalom_ros {

using geometry_msgs::msg::PoseArray;
using geometry_msgs::msg::PoseWithCovarianceStamped;
using nav_msgs::msg::OccupancyGrid;
using nav_msgs::msg::Odometry;
using nodes::LocaliserCore;
using rclcpp_lifecycle::LifecyclePublisher;
using sensor_msgs::msg::LaserScan;
using slalom::vehicle::LocaliserOutput;
using tf2_msgs::msg::TFMessage;

class LocaliserNode : public CoreNode<LocaliserCore> {
 public:
  explicit LocaliserNode(const rclcpp::NodeOptions& options)
      : CoreNode("localiser", options),
        pose_file_(setting<std::string>(
            "pose_file", "",
            "keeps the last pose; a node that is restarted within 10 s continues from it; empty: none")) {
    settings_.everywhere = setting("everywhere", settings_.everywhere, "search the whole map at the start");
    settings_.trust_scans =
        setting("trust_scans", settings_.trust_scans,
                "after a doubt the pose is trusted again after this number of consecutive good scans");
    settings_.trust_health = setting("trust_health", settings_.trust_health, "of these scans, 0 to 1");
    settings_.transform_tolerance = setting("transform_tolerance", settings_.transform_tolerance,
                                            "how far the stamps of the transforms are in the future [s]");
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const Pose start{setting("initial_pose.x", none, "of the car at the start [m]"),
                     setting("initial_pose.y", none, "of the car at the start [m]"),
                     setting("initial_pose.yaw", none, "of the car at the start [rad]")};
    if (std::isfinite(start.x) && std::isfinite(start.y) && std::isfinite(start.yaw)) told_ = start;
    out_.header.frame_id = map_;
    out_.child_frame_id = base_;
    transforms_.transforms.resize(1);
    transforms_.transforms[0].header.frame_id = map_;
  }

 protected:
  void set_up() override {
    pose_out_ = advertise<Odometry>("pf/pose/odom", rclcpp::QoS(1));
    cloud_out_ = advertise<PoseArray>("particlecloud", rclcpp::QoS(1));
    tf_out_ = advertise<TFMessage>("/tf", tf2_ros::DynamicBroadcasterQoS());
    LocaliserCore::Settings settings = settings_;
    settings.start = told_;
    settings.earlier = nodes::read_pose(pose_file_, wall_time());
    make_core(settings, {[this](const Pose& base, const LocaliserOutput& estimate, Stamp scan) {
                           publish(base, estimate, scan);
                         },
                         [this](const Pose& odometry_frame, Stamp stamp) {
                           set_transform(transforms_.transforms[0], odometry_frame, stamp);
                           tf_out_->publish(transforms_);
                         },
                         [this](const maps::OccupancyGrid& map) { course_map_ = message_of(map, map_); },
                         {},
                         {}});
    declare_options();
    core_->use_course();
    if (!settings_.course.empty()) map_out_ = advertise_latched<OccupancyGrid>("map");
  }

  void start() override {
    CoreNode::start();
    if (map_out_) {
      course_map_.header.stamp = now();
      map_out_->publish(course_map_);
    } else {
      subscribe<OccupancyGrid>(
          "map", rclcpp::QoS(1).transient_local(),
          [this](const OccupancyGrid& m) { core_->hear_map(grid_of(m)); }, from_middleware());
    }
    subscribe<Odometry>("odom", rclcpp::SensorDataQoS().keep_last(10),
                        [this](const Odometry& m) { hear(m); });
    subscribe<LaserScan>("scan", rclcpp::SensorDataQoS(), [this](const LaserScan& m) { hear_scan(m); });
    subscribe<PoseWithCovarianceStamped>(
        "initialpose", rclcpp::QoS(1),
        [this](const PoseWithCovarianceStamped& m) { core_->hear_start(pose_of(m.pose.pose)); });
  }

  nodes::Report report() override {
    if (const auto place = core_->reliable();
        place && !pose_file_.empty() && !nodes::write_pose(pose_file_, *place, wall_time()))
      RCLCPP_WARN_ONCE(get_logger(), "pose_file: %s cannot be written", pose_file_.c_str());
    if (cloud_out_->get_subscription_count() > 0) {
      PoseArray cloud;
      cloud.header.frame_id = map_;
      cloud.header.stamp = now();
      for (const Pose& p : core_->particles(300)) cloud.poses.push_back(message_of(p));
      cloud_out_->publish(cloud);
    }
    return CoreNode::report();
  }

 private:
  /// The time of the computer, s since 1970.
  static double wall_time() { return static_cast<double>(std::time(nullptr)); }

  void hear(const Odometry& m) {
    out_.twist = m.twist;
    transforms_.transforms[0].child_frame_id = m.header.frame_id;
    core_->hear_odometry(
        {stamp_of(m.header.stamp), pose_of(m.pose.pose), m.twist.twist.linear.x, m.twist.twist.angular.z});
  }

  void publish(const Pose& base, const LocaliserOutput& estimate, Stamp scan) {
    out_.header.stamp = time_of(scan);
    out_.pose.pose = message_of(base);
    constexpr std::size_t row[3] = {0, 1, 5};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        out_.pose.covariance[6 * row[i] + row[j]] = estimate.covariance[i][j];
    pose_out_->publish(out_);
  }

  std::string pose_file_;
  std::optional<Pose> told_;  ///< the start, if the parameters have one
  LifecyclePublisher<Odometry>* pose_out_ = nullptr;
  LifecyclePublisher<PoseArray>* cloud_out_ = nullptr;
  LifecyclePublisher<TFMessage>* tf_out_ = nullptr;
  LifecyclePublisher<OccupancyGrid>* map_out_ = nullptr;  ///< where there is a course
  // These messages are kept so that their memory is reused.
  Odometry out_;
  TFMessage transforms_;
  OccupancyGrid course_map_;
};

}  // namespace slalom_ros

RCLCPP_COMPONENTS_REGISTER_NODE(slalom_ros::LocaliserNode)
