#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>

#include "bridge/report.hpp"

/// Publishes the state of a node on `/diagnostics` once per second.
namespace slalom_ros1 {

class Diagnostics {
 public:
  explicit Diagnostics(ros::NodeHandle& node)
      : out_(node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 5)) {}

  /// Whether a second has passed since the last report.
  bool due() const { return ros::WallTime::now().toSec() - sent_ >= 1; }

  void send(const slalom_bridge::Report& report) {
    diagnostic_msgs::DiagnosticArray array;
    array.header.stamp = ros::Time::now();
    array.status.resize(1);
    array.status[0].level = static_cast<signed char>(report.level);
    array.status[0].name = ros::this_node::getName().substr(1) + ": " + report.about;
    array.status[0].hardware_id = "slalom";
    array.status[0].message = report.message;
    for (const auto& [key, value] : report.values) {
      array.status[0].values.emplace_back();
      array.status[0].values.back().key = key;
      array.status[0].values.back().value = value;
    }
    out_.publish(array);
    sent_ = ros::WallTime::now().toSec();
  }

 private:
  ros::Publisher out_;
  double sent_ = 0;
};

}  // namespace slalom_ros1
