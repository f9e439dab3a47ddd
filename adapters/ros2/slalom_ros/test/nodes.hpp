#pragma once

#include <map>
#include <utility>

#include <ackermann_msgs/msg/ackermann_drive_stamped.hpp>
#include <class_loader/class_loader.hpp>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <rcl_interfaces/msg/log.hpp>
#include <rclcpp_components/node_factory.hpp>

#include "harness.hpp"

namespace slalom_ros_test {

/// The nodes under test: each is a process, or all are components of this process with a thread each.
class Nodes {
 public:
  /// `place` is "processes" or "composed". Throws std::runtime_error otherwise.
  explicit Nodes(const std::string& place) : composed_(place == "composed") {
    expect(composed_ || place == "processes", "'" + place + "' must be processes or composed");
  }
  ~Nodes() {
    while (!components_.empty()) end(components_.begin()->first);
  }

  /// Starts a node of a kind ("planner") under a name, with parameters "name:=value".
  void start(const std::string& kind, const std::string& name, const std::vector<std::string>& parameters) {
    std::vector<std::string> words{"--ros-args", "-r", "__node:=" + name};
    for (const std::string& each : parameters) words.insert(words.end(), {"-p", each});
    if (composed_) return load(kind, name, words);
    words.insert(words.begin(), SLALOM_ROS_NODES "/" + kind + "_node");
    processes_[name] = std::make_unique<Process>(words);
  }
  /// A process ends without a chance to say so.
  void end(const std::string& name) {
    if (const auto process = processes_.find(name); process != processes_.end()) {
      process->second->end(SIGKILL);
      processes_.erase(process);
    }
    if (const auto component = components_.find(name); component != components_.end()) {
      component->second.executor->cancel();
      component->second.thread.join();
      components_.erase(component);
    }
  }

 private:
  struct Component {
    rclcpp_components::NodeInstanceWrapper node;
    std::unique_ptr<rclcpp::executors::SingleThreadedExecutor> executor;
    std::thread thread;
  };

  void load(std::string kind, const std::string& name, const std::vector<std::string>& words) {
    kind[0] = static_cast<char>(kind[0] - 'a' + 'A');
    const auto factory = loader_.createInstance<rclcpp_components::NodeFactory>(
        "rclcpp_components::NodeFactoryTemplate<slalom_ros::" + kind + "Node>");
    Component& made = components_[name];
    made.node =
        factory->create_node_instance(rclcpp::NodeOptions().arguments(words).use_intra_process_comms(true));
    made.executor = std::make_unique<rclcpp::executors::SingleThreadedExecutor>();
    made.executor->add_node(made.node.get_node_base_interface());
    made.thread = std::thread([executor = made.executor.get()] { executor->spin(); });
  }

  bool composed_;
  class_loader::ClassLoader loader_{SLALOM_ROS_NODES "/libslalom_ros_nodes.so"};
  std::map<std::string, std::unique_ptr<Process>> processes_;
  std::map<std::string, Component> components_;
};

/// A node that listens to the nodes under test: commands, log and diagnostics.
class Client : public TestNode {
 public:
  explicit Client(const std::string& name) : TestNode(name) {
    listen<ackermann_msgs::msg::AckermannDriveStamped>("drive", rclcpp::QoS(50), [this](const auto& m) {
      speed = static_cast<double>(m.drive.speed);
      commanded_at = steady_seconds();
      commands_.emplace_back(commanded_at, speed);
    });
    listen<rcl_interfaces::msg::Log>("/rosout", rclcpp::QoS(1000), [this](const auto& m) {
      log_.push_back({steady_seconds(), m.name, m.msg});
    });
    listen<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", rclcpp::QoS(20), [this](const auto& m) {
      for (const auto& status : m.status)
        for (const auto& pair : status.values) diagnostics[status.name][pair.key] = pair.value;
    });
  }

  /// The messages of a topic from now on, in the order of their arrival.
  template <class Message>
  std::shared_ptr<const std::vector<Message>> record(const std::string& topic, const rclcpp::QoS& qos) {
    const auto all = std::make_shared<std::vector<Message>>();
    listen<Message>(topic, qos, [all](const Message& m) { all->push_back(m); });
    return all;
  }

  /// Whether all commands of the last 0.3 s, of which there are some, drive, or stop.
  bool drives() const {
    return all_of_last(0.3, [](double v) { return v > 0.2; });
  }
  bool stops() const {
    return all_of_last(0.3, [](double v) { return v == 0; });
  }
  /// Whether a node has given these words as the reason for a stop since a time.
  bool has_said(const std::string& words, double since) const {
    for (const Line& line : log_)
      if (line.time >= since && line.text.rfind("stopping:", 0) == 0 &&
          line.text.find(words) != std::string::npos)
        return true;
    return false;
  }

  double speed = 0, commanded_at = 0;  ///< speed (m/s) and time (s, steady clock) of the last command
  std::map<std::string, std::map<std::string, std::string>> diagnostics;  ///< by status and key

 private:
  struct Line {
    double time;  // s, steady
    std::string node, text;
  };

  template <class Message, class Hear>
  void listen(const std::string& topic, const rclcpp::QoS& qos, Hear hear) {
    subscriptions_.push_back(node->create_subscription<Message>(
        topic, qos, [hear](const std::shared_ptr<const Message> m) { hear(*m); }));
  }
  template <class Holds>
  bool all_of_last(double seconds, Holds&& holds) const {
    int count = 0;
    const double since = steady_seconds() - seconds;
    for (auto c = commands_.rbegin(); c != commands_.rend() && c->first >= since; ++c, ++count)
      if (!holds(c->second)) return false;
    return count > 3;
  }
  std::string log() const override {
    std::string text;
    for (std::size_t i = log_.size() < 10 ? 0 : log_.size() - 10; i < log_.size(); ++i)
      text += "   " + log_[i].node + ": " + log_[i].text + "\n";
    return text;
  }

  std::vector<std::pair<double, double>> commands_;  // s, m/s
  std::vector<Line> log_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
};

}  // namespace slalom_ros_test
