#pragma once

#include <chrono>
#include <memory>
#include <type_traits>

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

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

}  // namespace slalom_ros
