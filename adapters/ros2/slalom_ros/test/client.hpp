#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <ackermann_msgs/msg/ackermann_drive_stamped.hpp>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <rcl_interfaces/msg/log.hpp>
#include <rclcpp/rclcpp.hpp>

namespace slalom_ros_test {

inline double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("FAILED: " + what);
}

/// A node that listens to the nodes under test: commands, log and diagnostics.
class Client {
 public:
  explicit Client(const std::string& name) : node(std::make_shared<rclcpp::Node>(name)) {
    using ackermann_msgs::msg::AckermannDriveStamped;
    using diagnostic_msgs::msg::DiagnosticArray;
    using rcl_interfaces::msg::Log;
    executor_.add_node(node);
    drive_in_ = node->create_subscription<AckermannDriveStamped>(
        "drive", rclcpp::QoS(50), [this](const AckermannDriveStamped::ConstSharedPtr m) {
          speed = static_cast<double>(m->drive.speed);
          commanded_at = steady_seconds();
          commands_.emplace_back(commanded_at, speed);
        });
    log_in_ =
        node->create_subscription<Log>("/rosout", rclcpp::QoS(1000), [this](const Log::ConstSharedPtr m) {
          log_.push_back({steady_seconds(), m->name, m->msg});
        });
    diagnostics_in_ = node->create_subscription<DiagnosticArray>(
        "/diagnostics", rclcpp::QoS(20), [this](const DiagnosticArray::ConstSharedPtr m) {
          for (const auto& status : m->status)
            for (const auto& pair : status.values) diagnostics[status.name][pair.key] = pair.value;
        });
  }

  /// Runs until something holds. Throws if it does not within this time (s).
  void wait(const std::string& what, const std::function<bool()>& holds, double seconds) {
    const double begin = steady_seconds();
    while (!holds()) {
      if (steady_seconds() - begin > seconds) throw std::runtime_error("FAILED: " + what + "\n" + last_log());
      spin();
    }
    std::printf("ok: %s (%.1f s)\n", what.c_str(), steady_seconds() - begin);
    std::fflush(stdout);
  }
  void run(double seconds) {
    for (const double begin = steady_seconds(); steady_seconds() - begin < seconds;) spin();
  }

  /// Calls a service and returns its answer. Throws if there is none within 10 s.
  template <class Service>
  typename Service::Response::SharedPtr call(
      const std::string& name, const typename Service::Request& request = typename Service::Request()) {
    const auto client = node->create_client<Service>(name);
    wait(
        name + ": is there", [&] { return client->service_is_ready(); }, 20);
    auto answer = client->async_send_request(std::make_shared<typename Service::Request>(request));
    wait(
        name + ": answers",
        [&] { return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }, 10);
    return answer.get();
  }

  /// Whether all commands of the last 0.3 s, of which there are some, drive, or stop.
  bool drives() const {
    return all_of_last(0.3, [](double v) { return v > 0.2; });
  }
  bool stops() const {
    return all_of_last(0.3, [](double v) { return v == 0; });
  }
  /// The first reason with these words that a node has logged since a time; empty if there is none.
  std::string reason(const std::string& words, double since) const {
    for (const Line& line : log_)
      if (line.time >= since && is_reason(line.text) && line.text.find(words) != std::string::npos)
        return line.node + ": " + line.text;
    return "";
  }
  rclcpp::Node::SharedPtr node;
  double speed = 0, commanded_at = 0;  ///< speed (m/s) and time (s, steady clock) of the last command
  std::map<std::string, std::map<std::string, std::string>> diagnostics;  ///< by status and key

 private:
  struct Line {
    double time;  // s, steady
    std::string node, text;
  };

  static bool is_reason(const std::string& text) {
    for (const char* word : {"stopping:", "braking:", "localisation:"})
      if (text.rfind(word, 0) == 0) return true;
    return false;
  }

  template <class Holds>
  bool all_of_last(double seconds, Holds&& holds) const {
    int count = 0;
    const double since = steady_seconds() - seconds;
    for (auto c = commands_.rbegin(); c != commands_.rend() && c->first >= since; ++c, ++count)
      if (!holds(c->second)) return false;
    return count > 3;
  }

  std::string last_log() const {
    std::string text;
    for (std::size_t i = log_.size() < 10 ? 0 : log_.size() - 10; i < log_.size(); ++i)
      text += "   " + log_[i].node + ": " + log_[i].text + "\n";
    return text;
  }

  void spin() {
    executor_.spin_some();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  rclcpp::executors::SingleThreadedExecutor executor_;
  std::vector<std::pair<double, double>> commands_;  // s, m/s
  std::vector<Line> log_;
  rclcpp::SubscriptionBase::SharedPtr drive_in_, log_in_, diagnostics_in_;
};

}  // namespace slalom_ros_test
