#pragma once

#include <tf2_ros/transform_listener.h>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include <chrono>
#include <memory>
#include <type_traits>

#include "conversions.hpp"
#include "logic/input_watch.hpp"
#include "logic/reports.hpp"
#include "option_parameters.hpp"

namespace slalom_ros {

/// A lifecycle node that publishes its state on `/diagnostics` once per second while it is active. With the
/// parameter `autostart` it configures and activates itself. A transition that throws fails with the message
/// in the log. All callbacks are in the default callback group, so they never run at the same time.
class ManagedNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  /// Calls `tick` once per `tick_period`.
  ManagedNode(const std::string& name, const rclcpp::NodeOptions& options,
              std::chrono::milliseconds tick_period);

  using State = rclcpp_lifecycle::State;
  using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
  CallbackReturn on_configure(const State& before) override;
  CallbackReturn on_activate(const State& before) override;
  CallbackReturn on_deactivate(const State& before) override;
  CallbackReturn on_cleanup(const State& before) override;
  CallbackReturn on_shutdown(const State& before) override;
  CallbackReturn on_error(const State& before) override;

 protected:
  // The work of a node in each transition; these may throw std::exception.
  virtual void set_up() = 0;     ///< unconfigured to inactive
  virtual void start() = 0;      ///< inactive to active; publishers are active
  virtual void stop() {}         ///< active to inactive; publishers are still active
  virtual void tear_down() = 0;  ///< inactive to unconfigured
  virtual void tick() {}         ///< every few milliseconds while active
  /// Reports the events since the last report; once per second while active.
  virtual nodes::Report report() = 0;

  /// A parameter that is fixed when the node is made.
  template <class Value>
  Value setting(const std::string& name, const Value& value, const std::string& description) {
    return declare_parameter<Value>(name, value, fixed(description));
  }

  /// Makes a publisher that exists until the node is cleaned up.
  template <class Message>
  rclcpp_lifecycle::LifecyclePublisher<Message>* advertise(const std::string& topic, const rclcpp::QoS& qos,
                                                           const rclcpp::PublisherOptions& options = {}) {
    const auto made = create_publisher<Message>(topic, qos, options);
    while_configured_.push_back(made);
    return made.get();
  }
  /// Makes a publisher whose last message later subscribers receive; Humble has none within a process.
  template <class Message>
  rclcpp_lifecycle::LifecyclePublisher<Message>* advertise_latched(const std::string& topic) {
    rclcpp::PublisherOptions options;
    options.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    return advertise<Message>(topic, rclcpp::QoS(1).transient_local(), options);
  }
  /// The options of a subscription that receives all messages from the middleware. Messages within a process
  /// are not latched and have no sender.
  static rclcpp::SubscriptionOptions from_middleware() {
    rclcpp::SubscriptionOptions options;
    options.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    return options;
  }

  /// Subscribes until the node is deactivated. An executor may already have taken messages when a transition
  /// drops their subscription, so these are not heard. `hear` takes a message, or also its MessageInfo.
  template <class Message, class Hear>
  void subscribe(const std::string& topic, const rclcpp::QoS& qos, Hear hear,
                 const rclcpp::SubscriptionOptions& options = {}) {
    while_active_.push_back(create_subscription<Message>(
        topic, qos,
        [this, hear = std::move(hear)](const std::shared_ptr<const Message>& m,
                                       const rclcpp::MessageInfo& info) {
          if (!active_) return;
          if constexpr (std::is_invocable_v<const Hear&, const Message&, const rclcpp::MessageInfo&>)
            hear(*m, info);
          else
            hear(*m);
        },
        options));
  }
  /// Offers a service until the node is cleaned up; after that, an answer has the defaults of its type.
  template <class Service, class Act>
  void serve(const std::string& name, Act act) {
    while_configured_.push_back(create_service<Service>(
        name, [this, act = std::move(act)](const typename Service::Request::SharedPtr asked,
                                           const typename Service::Response::SharedPtr answer) {
          if (configured_) act(*asked, *answer);
        }));
  }

  nodes::Clocks clocks() const;
  void warn(const std::string& message) const;
  void inform(const std::string& message) const;

 private:
  template <class Action>
  CallbackReturn attempt(const char* what, Action&& action);
  void send_report();
  void fall_silent();
  void end_activity();
  void end_configuration();

  std::chrono::milliseconds tick_period_;
  bool configured_ = false, active_ = false;
  std::vector<std::shared_ptr<void>> while_configured_, while_active_;
  rclcpp_lifecycle::LifecyclePublisher<diagnostic_msgs::msg::DiagnosticArray>* diagnostics_out_ = nullptr;
  rclcpp::TimerBase::SharedPtr autostart_timer_, tick_timer_, report_timer_;
};

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
