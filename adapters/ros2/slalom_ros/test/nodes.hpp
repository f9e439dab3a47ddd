#pragma once

#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <class_loader/class_loader.hpp>
#include <rclcpp/rclcpp.hpp>
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

}  // namespace slalom_ros_test
