#pragma once

#include <map>
#include <string>
#include <vector>

#include <rclcpp/generic_subscription.hpp>
#include <rclcpp/serialization.hpp>

#include "client.hpp"

namespace slalom_ros_test {

/// The messages of some topics as the wire has them, like those of a bag.
class Recording {
 public:
  explicit Recording(Client& client) : client_(client) {}

  void add(const std::string& topic, const std::string& type, const rclcpp::QoS& qos) {
    types_[topic] = type;
    subscriptions_.push_back(client_.node->create_generic_subscription(
        topic, type, qos, [this, topic](std::shared_ptr<rclcpp::SerializedMessage> m) {
          messages_[topic].emplace_back(steady_seconds(), *m);
        }));
  }

  std::size_t count(const std::string& topic) const {
    const auto found = messages_.find(topic);
    return found == messages_.end() ? 0 : found->second.size();
  }

  /// Reads the messages of a topic back, in the order of their arrival.
  template <class Message>
  std::vector<Message> read(const std::string& topic) const {
    std::vector<Message> all;
    const rclcpp::Serialization<Message> serialization;
    const auto found = messages_.find(topic);
    if (found == messages_.end()) return all;
    for (const auto& [time, bytes] : found->second) {
      all.emplace_back();
      serialization.deserialize_message(&bytes, &all.back());
    }
    return all;
  }

 private:
  Client& client_;
  std::map<std::string, std::string> types_;
  std::map<std::string, std::vector<std::pair<double, rclcpp::SerializedMessage>>> messages_;  // s, steady
  std::vector<rclcpp::GenericSubscription::SharedPtr> subscriptions_;
};

}  // namespace slalom_ros_test
