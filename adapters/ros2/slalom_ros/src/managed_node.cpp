#include "managed_node.hpp"

#include <exception>

#include <lifecycle_msgs/msg/state.hpp>

namespace slalom_ros {

using diagnostic_msgs::msg::DiagnosticArray;
using States = lifecycle_msgs::msg::State;

ManagedNode::ManagedNode(const std::string& name, const rclcpp::NodeOptions& options,
                         std::chrono::milliseconds tick_period)
    : rclcpp_lifecycle::LifecycleNode(name, options), tick_period_(tick_period) {
  if (!setting("autostart", false, "whether the node configures and activates itself")) return;
  autostart_timer_ = create_wall_timer(std::chrono::milliseconds(1), [this] {
    autostart_timer_->cancel();
    if (configure().id() == States::PRIMARY_STATE_INACTIVE) activate();
  });
}

/// A failed transition leaves the node in the state before it.
template <class Action>
ManagedNode::CallbackReturn ManagedNode::attempt(const char* what, Action&& action) {
  try {
    action();
    return CallbackReturn::SUCCESS;
  } catch (const std::exception& error) {
    RCLCPP_ERROR(get_logger(), "%s: %s", what, error.what());
    return CallbackReturn::FAILURE;
  }
}

ManagedNode::CallbackReturn ManagedNode::on_configure(const ManagedNode::State&) {
  const auto result = attempt("configure", [this] {
    diagnostics_out_ = advertise<DiagnosticArray>("/diagnostics", 5);
    set_up();
    configured_ = true;
  });
  if (result != CallbackReturn::SUCCESS) attempt("configure", [this] { end_configuration(); });
  return result;
}

ManagedNode::CallbackReturn ManagedNode::on_activate(const ManagedNode::State& before) {
  LifecycleNode::on_activate(before);
  const auto result = attempt("activate", [this] {
    start();
    active_ = true;
    tick_timer_ = create_wall_timer(tick_period_, [this] { tick(); });
    report_timer_ = create_wall_timer(std::chrono::seconds(1), [this] { send_report(); });
  });
  if (result != CallbackReturn::SUCCESS) {
    while_active_.clear();
    LifecycleNode::on_deactivate(before);
  }
  return result;
}

ManagedNode::CallbackReturn ManagedNode::on_deactivate(const ManagedNode::State& before) {
  fall_silent();
  const auto result = attempt("deactivate", [this] { end_activity(); });
  LifecycleNode::on_deactivate(before);
  return result;
}

ManagedNode::CallbackReturn ManagedNode::on_cleanup(const ManagedNode::State&) {
  return attempt("cleanup", [this] { end_configuration(); });
}

ManagedNode::CallbackReturn ManagedNode::on_shutdown(const ManagedNode::State& before) {
  fall_silent();
  return attempt("shutdown", [this, &before] {
    if (before.id() == States::PRIMARY_STATE_ACTIVE) end_activity();
    end_configuration();
  });
}

ManagedNode::CallbackReturn ManagedNode::on_error(const ManagedNode::State&) {
  fall_silent();
  return attempt("error", [this] { end_configuration(); });
}

void ManagedNode::end_activity() {
  stop();
  while_active_.clear();
}

void ManagedNode::end_configuration() {
  configured_ = false;
  while_active_.clear();
  tear_down();
  while_configured_.clear();
}

void ManagedNode::fall_silent() {
  active_ = false;
  tick_timer_.reset();
  report_timer_.reset();
}

void ManagedNode::send_report() {
  nodes::Report report = this->report();
  DiagnosticArray array;
  array.header.stamp = now();
  array.status.resize(1);
  auto& status = array.status[0];
  status.level = static_cast<unsigned char>(report.level);
  status.name =
      std::string(get_node_base_interface()->get_fully_qualified_name()).substr(1) + ": " + report.about;
  status.hardware_id = "slalom";
  status.message = report.message;
  for (auto& [key, value] : report.values) {
    status.values.emplace_back();
    status.values.back().key = key;
    status.values.back().value = std::move(value);
  }
  diagnostics_out_->publish(array);
}

nodes::Clocks ManagedNode::clocks() const {
  // The clock of the node follows the parameter use_sim_time.
  const rclcpp::Clock::SharedPtr clock = std::const_pointer_cast<rclcpp::Clock>(get_clock());
  return {[clock] { return 1e-9 * static_cast<double>(clock->now().nanoseconds()); },
          [] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
          }};
}

void ManagedNode::warn(const std::string& message) const {
  RCLCPP_WARN(get_logger(), "%s", message.c_str());
}
void ManagedNode::inform(const std::string& message) const {
  RCLCPP_INFO(get_logger(), "%s", message.c_str());
}

}  // namespace slalom_ros
