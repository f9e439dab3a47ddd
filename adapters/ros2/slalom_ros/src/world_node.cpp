// The simulator as a car: subscribes to `drive` and publishes `scan`, `odom` (wheel odometry) with its
// transforms, the parked cars, and the true state as `ground_truth`, `laps` and `contacts` (number of
// collisions). The core of the bridge does the work. The node `track` publishes map and path.
#include <cstdio>
#include <optional>

#include <ackermann_msgs/msg/ackermann_drive_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_srvs/srv/empty.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <tf2_ros/qos.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "bridge/world_core.hpp"
#include "conversions.hpp"
#include "managed_node.hpp"

namespace slalom_ros {

using ackermann_msgs::msg::AckermannDriveStamped;
using nav_msgs::msg::Odometry;
using rclcpp_lifecycle::LifecyclePublisher;
using sensor_msgs::msg::LaserScan;
using slalom_bridge::WorldCore;
using std_msgs::msg::Int32;
using std_srvs::srv::Empty;
using tf2_msgs::msg::TFMessage;
using visualization_msgs::msg::MarkerArray;

class WorldNode : public ManagedNode {
 public:
  explicit WorldNode(const rclcpp::NodeOptions& options)
      : ManagedNode("world", options, std::chrono::milliseconds(1)),
        map_(setting<std::string>("map_frame", "map", "frame of the true pose and of the parked cars")),
        odom_(setting<std::string>("odom_frame", "odom", "frame of the odometry")),
        base_(setting<std::string>("base_frame", "base_link", "frame of the middle of the rear axle")),
        laser_(setting<std::string>("laser_frame", "laser", "frame of the LiDAR")) {
    settings_.course = setting("course", settings_.course, "a name or a folder");
    settings_.seed = static_cast<std::uint64_t>(
        setting("seed", static_cast<std::int64_t>(settings_.seed), "of noise and parked cars"));
    settings_.obstacles = setting("obstacles", settings_.obstacles, "number of parked cars");
    settings_.command_timeout = setting("command_timeout", settings_.command_timeout,
                                        "without a command for this time it brakes [s]");
    transforms_.transforms.resize(1);
    transforms_.transforms[0].header.frame_id = odom_;
    transforms_.transforms[0].child_frame_id = base_;
  }

 protected:
  void set_up() override {
    scan_out_ = create_publisher<LaserScan>("scan", rclcpp::QoS(5));
    odometry_out_ = create_publisher<Odometry>("odom", rclcpp::QoS(10));
    truth_out_ = create_publisher<Odometry>("ground_truth", rclcpp::QoS(1));
    laps_out_ = create_publisher<Int32>("laps", rclcpp::QoS(1));
    contacts_out_ = create_publisher<Int32>("contacts", rclcpp::QoS(1));
    tf_out_ = create_publisher<TFMessage>("/tf", tf2_ros::DynamicBroadcasterQoS());
    tf_static_out_ = latched_publisher<TFMessage>("/tf_static");
    markers_out_ = latched_publisher<MarkerArray>("obstacles");
    core_.emplace(settings_, clocks(), [this](const std::string& message) { warn(message); });
    reset_service_ =
        serve<Empty>("reset", [this](const Empty::Request&, Empty::Response&) { core_->reset(); });
  }

  void start() override {
    TFMessage fixed;
    fixed.transforms.resize(1);
    fixed.transforms[0].header.frame_id = base_;
    fixed.transforms[0].child_frame_id = laser_;
    set_transform(fixed.transforms[0], core_->world().laser(), now().nanoseconds());
    tf_static_out_->publish(fixed);
    drive_in_ = subscribe<AckermannDriveStamped>(
        "drive", rclcpp::QoS(10),
        [this](const AckermannDriveStamped& m, const rclcpp::MessageInfo& info) {
          core_->hear_drive(sender_of(info.get_rmw_message_info().publisher_gid),
                            static_cast<double>(m.drive.steering_angle), static_cast<double>(m.drive.speed));
        },
        from_middleware());
  }

  void stop() override { drive_in_.reset(); }

  void tear_down() override {
    reset_service_.reset();
    core_.reset();
    scan_out_.reset();
    odometry_out_.reset();
    truth_out_.reset();
    laps_out_.reset();
    contacts_out_.reset();
    tf_out_.reset();
    tf_static_out_.reset();
    markers_out_.reset();
  }

  void tick() override {
    Stamp stamp = 0;
    if (core_->step_if_due(stamp)) publish(stamp);
  }
  slalom_bridge::Report report() override { return core_->report(); }

 private:
  /// A name of the publisher of a command.
  static std::string sender_of(const rmw_gid_t& publisher) {
    std::string name;
    char digits[3];
    for (const unsigned char byte : publisher.data) {
      std::snprintf(digits, sizeof digits, "%02x", byte);
      name += digits;
    }
    return name;
  }

  Odometry odometry(const Pose& p, const std::string& frame, Stamp stamp) const {
    Odometry m;
    m.header.stamp = time_of(stamp);
    m.header.frame_id = frame;
    m.child_frame_id = base_;
    m.pose.pose = message_of(p);
    m.twist.twist.linear.x = core_->world().reading().speed;
    m.twist.twist.angular.z = core_->world().reading().yaw_rate;
    return m;
  }

  visualization_msgs::msg::Marker box(int id, const std::string& frame, const Pose& pose) const {
    visualization_msgs::msg::Marker m;
    m.header.frame_id = frame;
    m.ns = frame;
    m.id = id;
    m.type = visualization_msgs::msg::Marker::CUBE;
    m.pose = message_of(pose);
    m.pose.position.z = 0.1;
    m.scale.x = core_->world().car_length();
    m.scale.y = core_->world().car_width();
    m.scale.z = 0.2;
    m.color.a = 0.8F;
    return m;
  }

  /// Publishes obstacles and car.
  void mark() {
    MarkerArray array;
    for (const Pose& p : core_->world().obstacles()) {
      array.markers.push_back(box(static_cast<int>(array.markers.size()), map_, p));
      array.markers.back().color.r = 0.9F;
    }
    constexpr double middle = 0.17145;  // m, of the car ahead of its rear axle
    array.markers.push_back(box(0, base_, {middle, 0, 0}));
    array.markers.back().color.g = 0.6F;
    array.markers.back().frame_locked = true;
    markers_out_->publish(array);
  }

  void publish(Stamp stamp) {
    if (core_->marks_due()) mark();
    const auto& seen = core_->world().reading();
    odometry_out_->publish(odometry(seen.odometry, odom_, stamp));
    truth_out_->publish(odometry(seen.truth, map_, stamp));
    set_transform(transforms_.transforms[0], seen.odometry, stamp);
    tf_out_->publish(transforms_);
    Int32 laps, contacts;
    laps.data = seen.laps;
    contacts.data = seen.contacts;
    laps_out_->publish(laps);
    contacts_out_->publish(contacts);
    scan_.header.stamp = time_of(stamp);
    scan_.header.frame_id = laser_;
    scan_.angle_min = static_cast<float>(seen.angle_min);
    scan_.angle_increment = static_cast<float>(seen.angle_increment);
    const double last = static_cast<double>(seen.ranges.size()) - 1;
    scan_.angle_max = static_cast<float>(seen.angle_min + seen.angle_increment * last);
    scan_.range_min = 0.02F;
    scan_.range_max = static_cast<float>(seen.range_max);
    scan_.ranges = seen.ranges;
    scan_out_->publish(scan_);
  }

  WorldCore::Settings settings_;
  std::string map_, odom_, base_, laser_;
  std::shared_ptr<LifecyclePublisher<LaserScan>> scan_out_;
  std::shared_ptr<LifecyclePublisher<Odometry>> odometry_out_, truth_out_;
  std::shared_ptr<LifecyclePublisher<Int32>> laps_out_, contacts_out_;
  std::shared_ptr<LifecyclePublisher<TFMessage>> tf_out_, tf_static_out_;
  std::shared_ptr<LifecyclePublisher<MarkerArray>> markers_out_;
  TFMessage transforms_;
  LaserScan scan_;
  std::optional<WorldCore> core_;
  rclcpp::SubscriptionBase::SharedPtr drive_in_;
  rclcpp::ServiceBase::SharedPtr reset_service_;
};

}  // namespace slalom_ros

RCLCPP_COMPONENTS_REGISTER_NODE(slalom_ros::WorldNode)
