#pragma once

#include <tf2_ros/transform_listener.h>

#include "conversions.hpp"
#include "managed_node.hpp"
#include "option_parameters.hpp"

namespace slalom_ros {

/// A node whose work a class of slalom::nodes does. Its options are parameters.
template <class Core>
class CoreNode : public ManagedNode {
 protected:
  CoreNode(const std::string& name, const rclcpp::NodeOptions& options)
      : ManagedNode(name, options, std::chrono::milliseconds(2)),
        base_(setting<std::string>("base_frame", "base_link", "frame of the car, x ahead and y to the left")),
        map_(setting<std::string>("map_frame", "map", "frame of the map and of the path")) {
    settings_.course =
        setting("course", settings_.course, "a name or a folder; empty: map and path are topics");
    settings_.rear_axle =
        setting("rear_axle", settings_.rear_axle, "x of the middle of the rear axle in the base frame [m]");
  }

  /// Makes the core. `outputs` need no log.
  void make_core(const typename Core::Settings& settings, typename Core::Outputs outputs) {
    outputs.warn = [this](const std::string& message) { warn(message); };
    outputs.inform = [this](const std::string& message) { inform(message); };
    core_.emplace(settings, clocks(), transforms_of(buffer_, map_, base_), std::move(outputs));
  }
  /// Declares the options of the core as parameters, and applies those of the user.
  void declare_options() {
    parameters_.emplace(
        *this, [this] { return core_->options(); },
        [this](const nodes::Changes& changes) { core_->change(changes); });
  }
  void hear_scan(const sensor_msgs::msg::LaserScan& m) {
    core_->hear_scan(stamp_of(m.header.stamp), m.header.frame_id, scan_of(m),
                     static_cast<double>(m.angle_max));
  }

  void start() override {
    listener_.emplace(buffer_, shared_from_this(), true, tf2_ros::DynamicListenerQoS(),
                      tf2_ros::StaticListenerQoS(), from_middleware(), from_middleware());
  }
  void stop() override { listener_.reset(); }
  void tear_down() override {
    parameters_.reset();
    core_.reset();
  }
  void tick() override { core_->tick(); }
  nodes::Report report() override {
    parameters_->refresh();
    return core_->report();
  }

  typename Core::Settings settings_;
  std::string base_, map_;  ///< frames
  std::optional<Core> core_;

 private:
  tf2::BufferCore buffer_;
  std::optional<tf2_ros::TransformListener> listener_;
  std::optional<OptionParameters> parameters_;
};

}  // namespace slalom_ros
