#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <class_loader/class_loader.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/node_factory.hpp>

#include "processes.hpp"

namespace slalom_ros_test {

/// The nodes under test: each is a process, or all are components of this process with a thread each.
class Nodes {
 public:
  enum class Place { processes, one_process };

  explicit Nodes(Place place) : place_(place) {}
  ~Nodes() {
    while (!components_.empty()) end(components_.begin()->first);
  }

  /// Starts a node of a kind ("planner") under a name, with parameters "name:=value", and remappings.
  void start(const std::string& kind, const std::string& name, const std::vector<std::string>& parameters,
             const std::vector<std::string>& remappings = {}) {
    std::vector<std::string> words{"--ros-args", "-r", "__node:=" + name};
    for (const std::string& each : remappings) words.insert(words.end(), {"-r", each});
    for (const std::string& each : parameters) words.insert(words.end(), {"-p", each});
    if (place_ == Place::one_process) return load(kind, name, words);
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

  Place place_;
  class_loader::ClassLoader loader_{SLALOM_ROS_NODES "/libslalom_ros_nodes.so"};
  std::map<std::string, std::unique_ptr<Process>> processes_;
  std::map<std::string, Component> components_;
};

/// The place that an argument of the program names.
inline Nodes::Place place_of(const std::string& word) {
  if (word == "processes") return Nodes::Place::processes;
  if (word == "composed") return Nodes::Place::one_process;
  throw std::invalid_argument("'" + word + "' must be processes or composed");
}

}  // namespace slalom_ros_test
