// Localisation and planner as one ROS 2 node: computes `drive` and the transform from map to odom from
// `scan`, `odom` and `map`; driver.hpp says when the car stops.
//
//   slalom_ros2_driver --course NAME [--configuration NAME] [--method NAME] [--domain N] [--map-from-topic]
//   [--sim-time] [--set section/option=value]
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "dds.hpp"
#include "driver.hpp"

namespace slalom_ros2 {
namespace {

using Clock = rosgraph_msgs_msg_dds__Clock_;
using Drive = ackermann_msgs_msg_dds__AckermannDriveStamped_;
using Grid = nav_msgs_msg_dds__OccupancyGrid_;
using Imu = sensor_msgs_msg_dds__Imu_;
using LaserScan = sensor_msgs_msg_dds__LaserScan_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using Stamp = builtin_interfaces_msg_dds__Time_;
using Transforms = tf2_msgs_msg_dds__TFMessage_;

std::atomic<bool> ended{false};

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
  Driver::Settings settings;
  unsigned domain = 0;
  bool sim_time = false;  ///< time is that of the topic `clock`
};

class DriverNode {
 public:
  explicit DriverNode(const Arguments& a)
      : node_("slalom_driver", a.domain),
        sim_time_(a.sim_time),
        driver_(a.settings, {[this] { return now(); }, steady},
                {[this](double steer, double speed) { send(steer, speed); },
                 [this](const Pose& odometry_frame) { send_transform(odometry_frame); },
                 [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }}) {
    drive_out_ =
        node_.writer(&ackermann_msgs_msg_dds__AckermannDriveStamped__desc, "drive", Quality::reliable);
    tf_out_ = node_.writer(&tf2_msgs_msg_dds__TFMessage__desc, "tf", Quality::reliable);
    scan_in_ = node_.reader(&sensor_msgs_msg_dds__LaserScan__desc, "scan", Quality::sensor_data);
    odometry_in_ = node_.reader(&nav_msgs_msg_dds__Odometry__desc, "odom", Quality::reliable);
    imu_in_ = node_.reader(&sensor_msgs_msg_dds__Imu__desc, "imu", Quality::sensor_data);
    others_in_ = node_.reader(&ackermann_msgs_msg_dds__AckermannDriveStamped__desc, "drive",
                              Quality::reliable, From::other_nodes);
    if (a.settings.map_from_topic)
      map_in_ = node_.reader(&nav_msgs_msg_dds__OccupancyGrid__desc, "map", Quality::latched);
    if (sim_time_)
      clock_in_ = node_.reader(&rosgraph_msgs_msg_dds__Clock__desc, "clock", Quality::sensor_data);
    node_.announce();
  }

  void spin() {
    while (!ended) {
      dds_sleepfor(DDS_MSECS(1));
      // First the clock, then what must be compared with it.
      if (clock_in_ > 0) take_all<Clock>(clock_in_, [&](const Clock& m) { sim_now_ = seconds(m.clock); });
      driver_.tick();
      if (map_in_ > 0) take_all<Grid>(map_in_, [&](const Grid& m) { hear_map(m); });
      take_all<Odometry>(odometry_in_, [&](const Odometry& m) {
        const auto& p = m.pose.pose;
        driver_.hear_odometry(seconds(m.header.stamp), {p.position.x, p.position.y, yaw_of(p.orientation)},
                              m.twist.twist.linear.x);
      });
      // A unit that is mounted along the axes of the base frame.
      take_all<Imu>(imu_in_, [&](const Imu& m) {
        driver_.hear_imu(m.angular_velocity.z, m.linear_acceleration.x, m.linear_acceleration.y);
      });
      take_all<Drive>(others_in_, [&](const Drive&) { driver_.hear_other_command(); });
      take_all<LaserScan>(scan_in_, [&](const LaserScan& m) {
        scan_stamp_ = m.header.stamp;
        driver_.hear_scan(
            seconds(m.header.stamp),
            {m.ranges._buffer, m.ranges._length, m.angle_min, m.angle_increment, m.range_min, m.range_max},
            m.angle_max);
      });
    }
  }

 private:
  double now() const {
    if (sim_time_) return sim_now_;
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
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
    driver_.hear_map(g);
  }

  void send(double steer, double speed) {
    Drive m{};
    m.header.stamp = stamp_of(now());
    m.header.frame_id = base_.data();
    m.drive.steering_angle = static_cast<float>(steer);
    m.drive.speed = static_cast<float>(speed);
    dds_write(drive_out_, &m);
  }

  void send_transform(const Pose& p) {
    geometry_msgs_msg_dds__TransformStamped_ t{};
    t.header.stamp = scan_stamp_;
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
  bool sim_time_;
  double sim_now_ = 0;  ///< s
  Driver driver_;
  dds_entity_t drive_out_ = 0, tf_out_ = 0, scan_in_ = 0, odometry_in_ = 0, map_in_ = 0, imu_in_ = 0,
               others_in_ = 0, clock_in_ = 0;
  Stamp scan_stamp_{};  ///< of the scan that the driver hears
  std::string base_ = "base_link", map_ = "map", odom_ = "odom";
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--map-from-topic" || word == "--sim-time") {
      (word == "--sim-time" ? a.sim_time : a.settings.map_from_topic) = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument(word + ": needs a value");
    const std::string value = argv[++i];
    if (word == "--course")
      a.settings.course = value;
    else if (word == "--configuration")
      a.settings.configuration = value;
    else if (word == "--method")
      a.settings.method = value;
    else if (word == "--domain")
      a.domain = static_cast<unsigned>(std::stoul(value));
    else if (word == "--set" && value.find('=') != std::string::npos)
      a.settings.set.emplace_back(value.substr(0, value.find('=')), value.substr(value.find('=') + 1));
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
  slalom_ros2::DriverNode(slalom_ros2::parse(argc, argv)).spin();
} catch (const std::exception& error) {
  std::fprintf(stderr, "slalom_ros2_driver: %s\n", error.what());
  return 1;
}
