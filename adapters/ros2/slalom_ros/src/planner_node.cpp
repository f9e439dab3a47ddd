// The controller: computes `drive` from `scan`, `odom` and tf, with a new plan for every scan. PlannerCore
// does the work. docs/on-the-car.md has topics, frames, parameters and faults.
#include <cmath>

#include <ackermann_msgs/msg/ackermann_drive_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/point_cloud2_iterator.hpp>
#include <slalom_msgs/msg/planner_metrics.hpp>
#include <slalom_msgs/msg/waypoints.hpp>
#include <slalom_msgs/srv/drive_laps.hpp>
#include <slalom_msgs/srv/save.hpp>
#include <std_msgs/msg/float32.hpp>

#include "logic/planner_core.hpp"
#include "managed_node.hpp"
#include "tracked_objects.hpp"

namespace slalom_ros {

using ackermann_msgs::msg::AckermannDriveStamped;
using nav_msgs::msg::Odometry;
using nodes::PlannerCore;
using rclcpp_lifecycle::LifecyclePublisher;
using sensor_msgs::msg::Imu;
using sensor_msgs::msg::LaserScan;
using slalom::vehicle::PlannerOutput;
using slalom_msgs::msg::PlannerMetrics;
using slalom_msgs::msg::TrackedObjects;
using slalom_msgs::msg::Waypoints;
using slalom_msgs::srv::DriveLaps;
using slalom_msgs::srv::Save;

class PlannerNode : public CoreNode<PlannerCore> {
 public:
  explicit PlannerNode(const rclcpp::NodeOptions& options) : CoreNode("planner", options) {
    settings_.configuration = setting("configuration", settings_.configuration, "a name or a file");
    settings_.method = setting("method", settings_.method, "the solver");
    settings_.limits.max_age =
        setting("timeout", settings_.limits.max_age, "the car stops if scan or odometry is older [s]");
    settings_.limits.settle_time = setting("settle_time", settings_.limits.settle_time,
                                           "how long the car stays stopped after a fault [s]");
    settings_.scan_interval =
        setting("scan_interval", settings_.scan_interval,
                "scans that come sooner after the last one used are not used; 0: all are used [s]");
    settings_.others =
        setting("others", settings_.others, "where the planner learns of other cars: none, scan or topic");
    settings_.view_port = setting("view_port", settings_.view_port,
                                  "port at which this computer serves the live view; 0: none");
    drive_.header.frame_id = base_;
  }

 protected:
  void set_up() override {
    drive_out_ = advertise<AckermannDriveStamped>("drive", rclcpp::QoS(1));
    metrics_out_ = advertise<PlannerMetrics>("mppi/eval_metrics", rclcpp::QoS(1));
    plan_out_ = advertise<nav_msgs::msg::Path>("plan", rclcpp::QoS(1));
    path_out_ = advertise_latched<nav_msgs::msg::Path>("reference_path");
    make_core(settings_, {[this](const slalom::Command& command) { send(command); },
                          [this](const PlannerOutput& output, Stamp scan) { show(output, scan); },
                          [this](const PlannerCore::Path& path, bool closed) { use_path(path, closed); },
                          {},
                          {}});
    limit_speed();
    declare_options();
    core_->use_course();
    serve<DriveLaps>("~/drive_laps", [this](const DriveLaps::Request& asked, DriveLaps::Response& answer) {
      attempt(answer, [&] { core_->drive_laps(asked.laps); });
    });
    serve<Save>("~/save", [this](const Save::Request& asked, Save::Response& answer) {
      attempt(answer, [&] { core_->save(asked.file); });
    });
  }

  void start() override {
    CoreNode::start();
    if (!path_.poses.empty()) path_out_->publish(path_);
    const auto sensor = rclcpp::SensorDataQoS();
    subscribe<LaserScan>("scan", sensor, [this](const LaserScan& m) {
      hear_scan(m);
      core_->tick();
    });
    subscribe<Odometry>("odom", sensor, [this](const Odometry& m) {
      core_->hear_odometry(stamp_of(m.header.stamp), m.twist.twist.linear.x);
    });
    subscribe<Odometry>("pf/pose/odom", sensor, [this](const Odometry& m) { hear_pose(m); });
    subscribe<AckermannDriveStamped>("executed", sensor, [this](const AckermannDriveStamped& m) {
      core_->hear_executed({static_cast<double>(m.drive.steering_angle), static_cast<double>(m.drive.speed)});
    });
    subscribe<sensor_msgs::msg::PointCloud2>("obstacle_points", sensor,
                                             [this](const auto& m) { hear_points(m); });
    subscribe<TrackedObjects>("tracked_objects", sensor, [this](const auto& m) { hear_objects(m); });
    subscribe<Imu>("imu", rclcpp::SensorDataQoS().keep_last(50), [this](const Imu& m) { hear_imu(m); });
    subscribe<AckermannDriveStamped>(
        "drive", rclcpp::QoS(10),
        [this](const AckermannDriveStamped&, const rclcpp::MessageInfo& info) {
          if (!(*drive_out_ == info.get_rmw_message_info().publisher_gid))
            core_->hear_other_command(others());
        },
        from_middleware());
    subscribe<std_msgs::msg::Float32>("goal_speed", rclcpp::QoS(1), [this](const std_msgs::msg::Float32& m) {
      core_->hear_goal_speed(static_cast<double>(m.data));
    });
    if (settings_.course.empty())
      subscribe<Waypoints>(
          "reference_waypoint", rclcpp::QoS(1).transient_local(),
          [this](const Waypoints& m) { hear_waypoints(m); }, from_middleware());
  }

  void stop() override {
    core_->halt();
    CoreNode::stop();
  }

 private:
  template <class Answer, class Action>
  static void attempt(Answer& answer, Action&& action) {
    try {
      action();
      answer.success = true;
    } catch (const std::exception& error) {
      answer.message = error.what();
    }
  }

  /// Limits the speed to 1 m/s unless the user has set a limit.
  void limit_speed() {
    const char* const name = "planner.max_speed";
    if (has_parameter(name) || get_node_parameters_interface()->get_parameter_overrides().count(name) > 0)
      return;
    core_->change({{"planner.max_speed", "1"}});
    inform("the car drives at most 1 m/s; the parameter planner.max_speed sets another limit");
  }

  /// The names of the other nodes that publish commands.
  std::string others() const {
    std::string names;
    for (const auto& publisher : get_publishers_info_by_topic(drive_out_->get_topic_name()))
      if (publisher.node_name() != get_name() || publisher.node_namespace() != get_namespace())
        names += (names.empty() ? "" : ", ") + publisher.node_name();
    return names;
  }

  void hear_imu(const Imu& m) {
    const auto &turn = m.angular_velocity, &acceleration = m.linear_acceleration;
    core_->hear_imu(
        {m.header.frame_id, {turn.x, turn.y, turn.z}, {acceleration.x, acceleration.y, acceleration.z}});
  }

  void hear_pose(const Odometry& m) {
    constexpr std::size_t row[3] = {0, 1, 5};
    slalom::vehicle::PoseCovariance covariance{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) covariance[i][j] = m.pose.covariance[6 * row[i] + row[j]];
    core_->hear_covariance(stamp_of(m.header.stamp), covariance);
  }

  void hear_points(const sensor_msgs::msg::PointCloud2& m) try {
    points_.clear();
    for (sensor_msgs::PointCloud2ConstIterator<float> x(m, "x"), y(m, "y"), z(m, "z"); x != x.end();
         ++x, ++y, ++z)
      points_.push_back({*x, *y, *z});
    core_->hear_points(stamp_of(m.header.stamp), m.header.frame_id, points_);
  } catch (const std::exception& error) {
    RCLCPP_WARN_ONCE(get_logger(), "obstacle_points: %s; ignored", error.what());
  }

  void hear_objects(const TrackedObjects& m) {
    if (m.header.frame_id == map_)
      core_->hear_objects(stamp_of(m.header.stamp), objects_of(m));
    else
      RCLCPP_WARN_ONCE(get_logger(), "tracked_objects: must be in the frame %s; ignored", map_.c_str());
  }

  void hear_waypoints(const Waypoints& m) {
    if (m.speeds.size() != m.poses.size())
      return warn("waypoints: the numbers of poses and speeds differ; ignored");
    PlannerCore::Path path;
    for (std::size_t i = 0; i < m.poses.size(); ++i) {
      const Pose p = pose_of(m.poses[i]);
      path.push_back({p.x, p.y, p.yaw, m.speeds[i]});
    }
    core_->hear_path(path);
  }

  void send(const slalom::Command& command) {
    drive_.header.stamp = now();
    drive_.drive.steering_angle = static_cast<float>(command.steer);
    drive_.drive.speed = static_cast<float>(command.speed);
    drive_out_->publish(drive_);
  }

  void use_path(const PlannerCore::Path& path, bool closed) {
    std::vector<Pose> poses;
    for (const maps::ReferencePoint& w : path) poses.push_back({w.x, w.y, w.yaw});
    if (closed) poses.push_back(poses.front());
    path_ = path_of(poses, map_, now().nanoseconds());
    if (path_out_->is_activated()) path_out_->publish(path_);
  }

  void show(const PlannerOutput& output, Stamp scan) {
    metrics_.header.stamp = time_of(scan);
    metrics_.status = slalom::vehicle::name(output.status);
    metrics_.state_cost = static_cast<float>(output.state_cost);
    metrics_.collision_cost = static_cast<float>(output.collision_cost);
    metrics_.input_error = 0;
    for (const float input : output.inputs) metrics_.input_error += std::abs(input);
    metrics_.effective_samples = output.solve ? static_cast<float>(output.solve->effective_sample_size) : 0;
    metrics_.calculation_time = static_cast<float>(1e3 * output.tick_time);
    metrics_out_->publish(metrics_);
    if (plan_out_->get_subscription_count() == 0) return;
    std::vector<Pose> poses;
    for (const auto& state : output.predicted) poses.push_back(state.pose);
    plan_out_->publish(path_of(poses, map_, scan));
  }

  LifecyclePublisher<AckermannDriveStamped>* drive_out_ = nullptr;
  LifecyclePublisher<PlannerMetrics>* metrics_out_ = nullptr;
  LifecyclePublisher<nav_msgs::msg::Path>*path_out_ = nullptr, *plan_out_ = nullptr;
  std::vector<std::array<double, 3>> points_;
  // These messages are kept so that their memory is reused.
  AckermannDriveStamped drive_;
  PlannerMetrics metrics_;
  nav_msgs::msg::Path path_;
};

}  // namespace slalom_ros

RCLCPP_COMPONENTS_REGISTER_NODE(slalom_ros::PlannerNode)
