#pragma once

#include <functional>

#include "test/faulty_car.hpp"
#include "wire.hpp"

namespace slalom_ros2_test {

/// A simulated car on the topics of ROS 2: publishes scans, odometry, transforms and a map, and follows
/// `drive`. Like a real car it brakes without a command for 0.2 s.
class Car {
 public:
  Car(const std::string& course, int obstacles, int domain)
      : peer_(domain),
        car_(course, 1, obstacles),
        scan_(peer_.writer<sensor_msgs::msg::LaserScanPubSubType>("rt/scan", Quality::sensor_data)),
        odometry_(peer_.writer<nav_msgs::msg::OdometryPubSubType>("rt/odom", Quality::reliable)),
        tf_(peer_.writer<tf2_msgs::msg::TFMessagePubSubType>("rt/tf", Quality::reliable)),
        map_(peer_.writer<nav_msgs::msg::OccupancyGridPubSubType>("rt/map", Quality::latched)),
        clock_(peer_.writer<rosgraph_msgs::msg::ClockPubSubType>("rt/clock", Quality::sensor_data)),
        drive_(peer_.reader<ackermann_msgs::msg::AckermannDriveStampedPubSubType>("rt/drive",
                                                                                  Quality::reliable)),
        tf_in_(peer_.reader<tf2_msgs::msg::TFMessagePubSubType>("rt/tf", Quality::reliable)),
        nodes_(peer_.reader<rmw_dds_common::msg::ParticipantEntitiesInfoPubSubType>("ros_discovery_info",
                                                                                    Quality::latched)) {
    send_map();
  }

  std::function<void(double speed)> on_command;  ///< m/s, of each command that arrives

  /// One step of 25 ms; its messages have the stamp `t` (s).
  void step(double t) {
    hear();
    const bool commanded = now() - heard_ < 0.2;
    car_.step(steer_, commanded ? speed_ : 0, t);
    for (const auto& m : car_.odometry) send(m);
    for (const auto& m : car_.scans) send(m);
  }
  void begin(const slalom_bridge::testing::Fault& fault) {
    car_.begin(fault);
    if (fault.of == "map") send_map();
  }
  /// Ends the fault.
  void end() {
    const bool was_of_map = car_.fault() && car_.fault()->of == "map";
    car_.end();
    if (was_of_map) send_map();
  }
  /// Publishes the time `t` (s).
  void send_clock(double t) {
    rosgraph_msgs::msg::Clock m;
    m.clock(time_message(t));
    clock_->write(&m);
  }

  double commanded_speed() const { return speed_; }
  const slalom_bridge::World::Reading& reading() const { return car_.reading(); }
  long commands() const { return commands_; }
  bool knows_node() const { return knows_node_; }
  bool heard_transform() const { return heard_transform_; }

 private:
  void hear() {
    SampleInfo info;
    ackermann_msgs::msg::AckermannDriveStamped drive;
    while (drive_->take_next_sample(&drive, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || !std::isfinite(drive.drive().speed())) continue;
      steer_ = static_cast<double>(drive.drive().steering_angle());
      speed_ = static_cast<double>(drive.drive().speed());
      heard_ = now();
      ++commands_;
      if (on_command) on_command(speed_);
    }
    tf2_msgs::msg::TFMessage tf;
    while (tf_in_->take_next_sample(&tf, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data)
        for (const auto& t : tf.transforms()) heard_transform_ |= t.header().frame_id() == "map";
    rmw_dds_common::msg::ParticipantEntitiesInfo nodes;
    while (nodes_->take_next_sample(&nodes, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data)
        for (const auto& n : nodes.node_entities_info_seq())
          knows_node_ |= n.node_name() == "slalom_driver" && n.writer_gid_seq().size() == 2;
  }

  void send(const slalom_bridge::testing::OdometryMessage& m) {
    nav_msgs::msg::Odometry odometry;
    odometry.header(header(m.stamp, "odom"));
    odometry.child_frame_id("base_link");
    odometry.pose().pose().position().x(m.pose.x);
    odometry.pose().pose().position().y(m.pose.y);
    odometry.pose().pose().orientation(quaternion(m.pose.yaw));
    odometry.twist().twist().linear().x(m.speed);
    odometry.twist().twist().angular().z(m.yaw_rate);
    odometry_->write(&odometry);
    geometry_msgs::msg::TransformStamped transform;
    transform.header(header(m.stamp, "odom"));
    transform.child_frame_id("base_link");
    transform.transform().translation().x(m.pose.x);
    transform.transform().translation().y(m.pose.y);
    transform.transform().rotation(quaternion(m.pose.yaw));
    tf2_msgs::msg::TFMessage tf;
    tf.transforms().push_back(transform);
    tf_->write(&tf);
  }

  void send(const slalom_bridge::testing::ScanMessage& m) {
    sensor_msgs::msg::LaserScan scan;
    scan.header(header(m.stamp, "laser"));
    scan.angle_min(static_cast<float>(m.angle_min));
    scan.angle_increment(static_cast<float>(m.angle_increment));
    scan.angle_max(static_cast<float>(m.angle_max));
    scan.range_min(static_cast<float>(m.range_min));
    scan.range_max(static_cast<float>(m.range_max));
    scan.ranges(m.ranges);
    scan_->write(&scan);
  }

  void send_map() {
    const slalom_bridge::Grid grid = car_.map();
    nav_msgs::msg::OccupancyGrid m;
    m.header(header(now(), "map"));
    m.info().resolution(static_cast<float>(grid.resolution));
    m.info().width(static_cast<std::uint32_t>(grid.width));
    m.info().height(static_cast<std::uint32_t>(grid.height));
    m.info().origin().position().x(grid.origin.x);
    m.info().origin().position().y(grid.origin.y);
    m.info().origin().orientation(quaternion(grid.origin.yaw));
    m.data().assign(grid.cells.begin(), grid.cells.end());
    map_->write(&m);
  }

  Peer peer_;
  slalom_bridge::testing::FaultyCar car_;
  DataWriter *scan_, *odometry_, *tf_, *map_, *clock_;
  DataReader *drive_, *tf_in_, *nodes_;
  double steer_ = 0, speed_ = 0, heard_ = 0;
  long commands_ = 0;
  bool knows_node_ = false, heard_transform_ = false;
};

}  // namespace slalom_ros2_test
