#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>

/// Publishes the state of a node on `/diagnostics` once per second.
namespace slalom_ros {

class Diagnostics {
 public:
  explicit Diagnostics(ros::NodeHandle& node)
      : out_(node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 5)) {}

  /// Whether a second has passed since the last report.
  bool due() const { return ros::WallTime::now().toSec() - sent_ >= 1; }

  template <class Value>
  void add(const std::string& key, const Value& value) {
    diagnostic_msgs::KeyValue pair;
    pair.key = key;
    std::ostringstream text;
    text << value;
    pair.value = text.str();
    values_.push_back(pair);
  }

  /// `level` as in diagnostic_msgs/DiagnosticStatus: 0 ok, 1 warning, 2 error.
  void send(int level, const std::string& message, const std::string& about) {
    diagnostic_msgs::DiagnosticArray array;
    array.header.stamp = ros::Time::now();
    array.status.resize(1);
    array.status[0].level = static_cast<signed char>(level);
    array.status[0].name = ros::this_node::getName().substr(1) + ": " + about;
    array.status[0].hardware_id = "slalom";
    array.status[0].message = message;
    array.status[0].values.swap(values_);
    values_.clear();
    out_.publish(array);
    sent_ = ros::WallTime::now().toSec();
  }

 private:
  ros::Publisher out_;
  std::vector<diagnostic_msgs::KeyValue> values_;
  double sent_ = 0;
};

}  // namespace slalom_ros
