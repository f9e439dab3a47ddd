// The simulator as a car: subscribes to `drive` and publishes `scan`, `odom` (wheel odometry) with its
// transforms, the parked cars, and the true state as `ground_truth`, `laps` and `collisions`. Like a real car
// it must brake without a finite command for a while, or when two nodes command it.
#include <map>

#include <ackermann_msgs/msg/ackermann_drive_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_srvs/srv/empty.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <tf2_ros/qos.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "conversions.hpp"
#include "logic/installed.hpp"
#include "logic/simulated_car.hpp"
#include "managed_node.hpp"

namespace slalom_ros {

using ackermann_msgs::msg::AckermannDriveStamped;
using nav_msgs::msg::Odometry;
using nodes::SimulatedCar;
using rclcpp_lifecycle::LifecyclePublisher;
using sensor_msgs::msg::LaserScan;
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
        laser_(setting<std::string>("laser_frame", "laser", "frame of the LiDAR")),
        course_(setting<std::string>("course", "wren", "a name or a folder")),
        seed_(setting<std::int64_t>("seed", 1, "of noise and parked cars")),
        obstacles_(setting("obstacles", 5, "number of parked cars")),
        command_timeout_(setting("command_timeout", 0.2, "without a command for this time it brakes [s]")) {
    transforms_.transforms.resize(1);
    transforms_.transforms[0].header.frame_id = odom_;
    transforms_.transforms[0].child_frame_id = base_;
  }

 protected:
  void set_up() override {
    scan_out_ = advertise<LaserScan>("scan", rclcpp::QoS(5));
    odometry_out_ = advertise<Odometry>("odom", rclcpp::QoS(10));
    truth_out_ = advertise<Odometry>("ground_truth", rclcpp::QoS(1));
    laps_out_ = advertise<Int32>("laps", rclcpp::QoS(1));
    collisions_out_ = advertise<Int32>("collisions", rclcpp::QoS(1));
    tf_out_ = advertise<TFMessage>("/tf", tf2_ros::DynamicBroadcasterQoS());
    tf_static_out_ = advertise_latched<TFMessage>("/tf_static");
    markers_out_ = advertise_latched<MarkerArray>("obstacles");
    car_.emplace(nodes::load_course(course_), static_cast<std::uint64_t>(seed_), obstacles_);
    due_ = nodes::stamp_of(clocks_.now());
    serve<Empty>("reset", [this](const Empty::Request&, Empty::Response&) { car_->reset(); });
  }

  void start() override {
    TFMessage fixed;
    fixed.transforms.resize(1);
    fixed.transforms[0].header.frame_id = base_;
    fixed.transforms[0].child_frame_id = laser_;
    set_transform(fixed.transforms[0], car_->laser(), now().nanoseconds());
    tf_static_out_->publish(fixed);
    subscribe<AckermannDriveStamped>(
        "drive", rclcpp::QoS(10),
        [this](const AckermannDriveStamped& m, const rclcpp::MessageInfo& info) {
          const auto& sender = info.get_rmw_message_info().publisher_gid.data;
          hear({static_cast<double>(m.drive.steering_angle), static_cast<double>(m.drive.speed)},
               std::string(std::begin(sender), std::end(sender)));
        },
        from_middleware());
  }

  void tear_down() override { car_.reset(); }

  void tick() override {
    constexpr Stamp furthest_ahead = 1'000'000'000, furthest_behind = 500'000'000;  // ns
    log_.flush();
    const Stamp time = nodes::stamp_of(clocks_.now());
    if (due_ > time + furthest_ahead || due_ < time - furthest_behind)
      due_ = time;  // the clock jumped, or this process was stopped
    if (time < due_) return;
    car_->step({command_.steer, is_commanded() ? command_.speed : 0});
    publish(due_);
    due_ += nodes::stamp_of(SimulatedCar::period);
  }

  nodes::Report report() override {
    nodes::Report r;
    r.about = "simulated car";
    r.add("speed, m/s", car_->odometry().speed());
    r.add("laps", car_->laps());
    r.add("collisions", car_->collisions());
    r.message = why_.empty() ? "driving" : "braking: " + why_;
    r.level = why_.empty() ? nodes::Level::ok : nodes::Level::warning;
    why_.clear();
    return r;
  }

 private:
  void hear(const slalom::Command& command, const std::string& sender) {
    if (!std::isfinite(command.steer) || !std::isfinite(command.speed))
      return log_("a command is not finite");
    command_ = command;
    heard_[sender] = clocks_.steady();
  }

  /// Whether exactly one node commands the car.
  bool is_commanded() {
    const auto speaking = std::count_if(heard_.begin(), heard_.end(), [this](const auto& sender) {
      return clocks_.steady() - sender.second <= command_timeout_;
    });
    if (speaking == 1) return true;
    why_ = speaking == 0 ? "no command" : "commanded by more than one";
    if (speaking > 1) log_("braking: " + why_);
    return false;
  }

  Odometry odometry(const Pose& p, const std::string& frame, Stamp stamp) const {
    Odometry m;
    m.header.stamp = time_of(stamp);
    m.header.frame_id = frame;
    m.child_frame_id = base_;
    m.pose.pose = message_of(p);
    m.twist.twist.linear.x = car_->odometry().speed();
    m.twist.twist.angular.z = car_->odometry().yaw_rate();
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
    m.scale.x = car_->parameters().length;
    m.scale.y = car_->parameters().width;
    m.scale.z = 0.2;
    m.color.a = 0.8F;
    return m;
  }

  /// Publishes markers of the parked cars and the car.
  void mark() {
    MarkerArray array;
    for (const Pose& p : car_->parked()) {
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
    // A display discards markers that it has no transform for yet, so they are repeated each second.
    constexpr int steps_per_second = 40;
    if (++steps_ % steps_per_second == 1) mark();
    odometry_out_->publish(odometry(car_->odometry().pose(), odom_, stamp));
    truth_out_->publish(odometry(car_->pose(), map_, stamp));
    set_transform(transforms_.transforms[0], car_->odometry().pose(), stamp);
    tf_out_->publish(transforms_);
    Int32 laps, collisions;
    laps.data = car_->laps();
    collisions.data = car_->collisions();
    laps_out_->publish(laps);
    collisions_out_->publish(collisions);
    const maps::LaserScanView seen = car_->scan();
    scan_.header.stamp = time_of(stamp);
    scan_.header.frame_id = laser_;
    scan_.angle_min = static_cast<float>(seen.angle_min);
    scan_.angle_increment = static_cast<float>(seen.angle_increment);
    const double last = static_cast<double>(seen.ranges.size()) - 1;
    scan_.angle_max = static_cast<float>(seen.angle_min + seen.angle_increment * last);
    scan_.range_min = 0.02F;
    scan_.range_max = static_cast<float>(seen.range_max);
    scan_.ranges.assign(seen.ranges.begin(), seen.ranges.end());
    scan_out_->publish(scan_);
  }

  std::string map_, odom_, base_, laser_, course_;
  std::int64_t seed_;
  int obstacles_;
  double command_timeout_;  ///< s
  LifecyclePublisher<LaserScan>* scan_out_ = nullptr;
  LifecyclePublisher<Odometry>*odometry_out_ = nullptr, *truth_out_ = nullptr;
  LifecyclePublisher<Int32>*laps_out_ = nullptr, *collisions_out_ = nullptr;
  LifecyclePublisher<TFMessage>*tf_out_ = nullptr, *tf_static_out_ = nullptr;
  LifecyclePublisher<MarkerArray>* markers_out_ = nullptr;
  TFMessage transforms_;
  LaserScan scan_;
  nodes::Clocks clocks_ = clocks();
  nodes::ThrottledLog log_{clocks_.steady, [this](const std::string& message) { warn(message); }};
  std::optional<SimulatedCar> car_;
  slalom::Command command_;
  std::map<std::string, double> heard_;  ///< time of the last command of each node, s, steady clock
  Stamp due_ = 0;                        ///< time of the next step
  long steps_ = 0;
  std::string why_;  ///< the reason if the car has braked since the last report
};

}  // namespace slalom_ros

RCLCPP_COMPONENTS_REGISTER_NODE(slalom_ros::WorldNode)
