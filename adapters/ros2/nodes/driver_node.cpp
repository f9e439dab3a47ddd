// Localisation and planner as one ROS 2 node: computes `drive` and the transform from map to odom from
// `scan`, `odom` and `map`. If an input is missing, late, out of order, from the future or invalid, it sends
// speed 0 and logs the reason at most once per second. It continues by itself once the inputs have been valid
// for a moment.
//
//   slalom_ros2_driver --course NAME [--configuration NAME] [--method NAME] [--domain N] [--set
//   section/option=value]
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <optional>

#include "bridge/bridge.hpp"
#include "dds.hpp"

namespace slalom_ros2 {
namespace {

using slalom_bridge::Pose;
using Drive = ackermann_msgs_msg_dds__AckermannDriveStamped_;
using Grid = nav_msgs_msg_dds__OccupancyGrid_;
using Imu = sensor_msgs_msg_dds__Imu_;
using LaserScan = sensor_msgs_msg_dds__LaserScan_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using Stamp = builtin_interfaces_msg_dds__Time_;
using Transforms = tf2_msgs_msg_dds__TFMessage_;

std::atomic<bool> ended{false};

double now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}
double steady() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double seconds(const Stamp& t) {
  return t.sec + 1e-9 * t.nanosec;
}
Stamp stamp_of(double t) {
  Stamp made{};
  made.sec = static_cast<int32_t>(std::floor(t));
  made.nanosec = static_cast<uint32_t>((t - std::floor(t)) * 1e9);
  return made;
}
double yaw_of(const geometry_msgs_msg_dds__Quaternion_& q) {
  return std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}

struct Arguments {
  std::string course = "wren", configuration = "default", method = "svg_mppi";
  unsigned domain = 0;
  bool map_from_topic = false;
  slalom_bridge::Changes set;
};

class Driver {
 public:
  explicit Driver(const Arguments& a)
      : node_("slalom_driver", a.domain), planner_(a.configuration, a.method) {
    const auto course = slalom_bridge::load_course(a.course);
    planner_.change(a.set);
    planner_.use_path(course.waypoints);
    start_ = course.start;
    if (!a.map_from_topic) use_map(course.map);
    drive_out_ =
        node_.writer(&ackermann_msgs_msg_dds__AckermannDriveStamped__desc, "drive", Quality::reliable);
    tf_out_ = node_.writer(&tf2_msgs_msg_dds__TFMessage__desc, "tf", Quality::reliable);
    scan_in_ = node_.reader(&sensor_msgs_msg_dds__LaserScan__desc, "scan", Quality::sensor_data);
    odometry_in_ = node_.reader(&nav_msgs_msg_dds__Odometry__desc, "odom", Quality::reliable);
    imu_in_ = node_.reader(&sensor_msgs_msg_dds__Imu__desc, "imu", Quality::sensor_data);
    if (a.map_from_topic)
      map_in_ = node_.reader(&nav_msgs_msg_dds__OccupancyGrid__desc, "map", Quality::latched);
    node_.announce();
  }

  void spin() {
    while (!ended) {
      dds_sleepfor(DDS_MSECS(1));
      if (map_in_ > 0) take_all<Grid>(map_in_, [&](const Grid& m) { hear_map(m); });
      take_all<Odometry>(odometry_in_, [&](const Odometry& m) { hear_odometry(m); });
      // A unit that is mounted along the axes of the base frame.
      take_all<Imu>(imu_in_, [&](const Imu& m) {
        imu_.add(m.angular_velocity.z, m.linear_acceleration.x, m.linear_acceleration.y);
      });
      take_all<LaserScan>(scan_in_, [&](const LaserScan& m) { hear_scan(m); });
      if (steady() - sent_ < 1.6 * planner_.control_period()) continue;
      if (last_scan_ == 0 || now() - last_scan_ > max_age) fault("no scan");
      if (steady() - fault_at_ < settle_time) stop();
    }
  }

 private:
  static constexpr double max_age = 0.15, max_future = 0.05, settle_time = 0.25;  // s

  void use_map(const slalom_bridge::Grid& map) {
    localiser_.use_map(map);
    localiser_.start_at(start_);
  }

  void fault(const std::string& why) {
    why_ = why;
    fault_at_ = steady();
  }
  void stop() {
    if (steady() - said_ >= 1) {
      std::fprintf(stderr, "stopping: %s\n", why_.c_str());
      said_ = steady();
    }
    send(steer_, 0);
  }

  bool in_time(const char* what, double stamp, double last) {
    const double age = now() - stamp;
    if (age < -max_future) {
      fault(std::string(what) + " from the future");
    } else if (stamp <= last) {
      fault(std::string(what) + " out of order");
      if (last - now() > max_future) last_scan_ = last_odometry_ = 0;  // the clock was set back
    } else if (age > max_age) {
      fault(std::string(what) + " late");
    } else {
      return true;
    }
    return false;
  }

  void hear_map(const Grid& m) {
    slalom_bridge::Grid g{
        static_cast<int>(m.info.width),
        static_cast<int>(m.info.height),
        m.info.resolution,
        {m.info.origin.position.x, m.info.origin.position.y, yaw_of(m.info.origin.orientation)},
        {}};
    for (uint32_t i = 0; i < m.data._length; ++i)
      g.cells.push_back(static_cast<std::int8_t>(m.data._buffer[i]));
    try {
      use_map(g);
    } catch (const std::exception& error) {
      fault(std::string("map: ") + error.what());
    }
  }

  void hear_odometry(const Odometry& m) {
    const double stamp = seconds(m.header.stamp);
    if (!in_time("odometry", stamp, last_odometry_)) return;
    last_odometry_ = stamp;
    odometry_ = {m.pose.pose.position.x, m.pose.pose.position.y, yaw_of(m.pose.pose.orientation)};
    speed_ = m.twist.twist.linear.x;
  }

  void hear_scan(const LaserScan& m) {
    const double stamp = seconds(m.header.stamp);
    if (!in_time("scan", stamp, last_scan_)) return stop();
    last_scan_ = stamp;
    const double promised = (static_cast<double>(m.angle_max) - m.angle_min) / m.angle_increment + 1;
    if (!(std::abs(promised - m.ranges._length) <= 1.5)) fault("the scan's count does not fit its angles");
    if (std::abs(stamp - last_odometry_) > 0.1) fault("no odometry of the scan's time");
    if (!localiser_.has_map()) fault("no map");
    if (steady() - fault_at_ < settle_time) return stop();
    const slalom_bridge::Scan scan{m.ranges._buffer,  m.ranges._length, m.angle_min,
                                   m.angle_increment, m.range_min,      m.range_max};
    const auto seen = localiser_.update(scan, odometry_, stamp);
    if (!seen.usable) fault("localisation: " + seen.status);
    if (seen.usable) send_transform(seen.odometry_frame, m.header.stamp);
    if (!seen.usable && stamp - placed_ > 0.1) return stop();
    if (seen.usable) placed_ = stamp;
    const auto command = planner_.update(scan, seen.pose, speed_, imu_);
    imu_.clear();
    report(command);
    if (!command.ok && steady() - said_ >= 1) {
      std::fprintf(stderr, "braking: %s\n", command.status.c_str());
      said_ = steady();
    }
    steer_ = command.steer;
    send(command.steer, command.speed);
  }

  /// Once in ten seconds, what is known of car and ground.
  void report(const slalom_bridge::Command& command) {
    if (command.friction == 0 || steady() - reported_ < 10) return;
    reported_ = steady();
    std::fprintf(
        stderr,
        "friction %.2f +- %.2f (plans rely on %.2f, confidence %.2f), steering gain %.2f, delay %.0f ms\n",
        command.friction, command.friction_deviation, command.cautious_friction, command.confidence,
        command.steering_gain, 1e3 * command.delay);
  }

  void send(double steer, double speed) {
    Drive m{};
    m.header.stamp = stamp_of(now());
    m.header.frame_id = base_.data();
    m.drive.steering_angle = static_cast<float>(steer);
    m.drive.speed = static_cast<float>(speed);
    dds_write(drive_out_, &m);
    sent_ = steady();
  }

  void send_transform(const Pose& p, const Stamp& stamp) {
    geometry_msgs_msg_dds__TransformStamped_ t{};
    t.header.stamp = stamp;
    t.header.frame_id = map_.data();
    t.child_frame_id = odom_.data();
    t.transform.translation.x = p.x;
    t.transform.translation.y = p.y;
    t.transform.rotation.z = std::sin(p.yaw / 2);
    t.transform.rotation.w = std::cos(p.yaw / 2);
    Transforms m{};
    m.transforms._buffer = &t;
    m.transforms._length = m.transforms._maximum = 1;
    dds_write(tf_out_, &m);
  }

  Node node_;
  slalom_bridge::Planner planner_;
  slalom_bridge::Localiser localiser_;
  dds_entity_t drive_out_ = 0, tf_out_ = 0, scan_in_ = 0, odometry_in_ = 0, map_in_ = 0, imu_in_ = 0;
  slalom_bridge::ImuSamples imu_;
  double reported_ = 0;
  std::string base_ = "base_link", map_ = "map", odom_ = "odom", why_;
  Pose start_, odometry_;
  double speed_ = 0, steer_ = 0, last_scan_ = 0, last_odometry_ = 0, placed_ = 0, sent_ = 0, said_ = 0,
         fault_at_ = -1e9;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--map-from-topic") {
      a.map_from_topic = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument(word + ": needs a value");
    const std::string value = argv[++i];
    if (word == "--course")
      a.course = value;
    else if (word == "--configuration")
      a.configuration = value;
    else if (word == "--method")
      a.method = value;
    else if (word == "--domain")
      a.domain = static_cast<unsigned>(std::stoul(value));
    else if (word == "--set" && value.find('=') != std::string::npos)
      a.set.emplace_back(value.substr(0, value.find('=')), value.substr(value.find('=') + 1));
    else
      throw std::invalid_argument(word + " " + value + ": is not known");
  }
  return a;
}

}  // namespace
}  // namespace slalom_ros2

int main(int argc, char** argv) try {
  std::signal(SIGINT, [](int) { slalom_ros2::ended = true; });
  std::signal(SIGTERM, [](int) { slalom_ros2::ended = true; });
  slalom_ros2::Driver(slalom_ros2::parse(argc, argv)).spin();
} catch (const std::exception& error) {
  std::fprintf(stderr, "slalom_ros2_driver: %s\n", error.what());
  return 1;
}
