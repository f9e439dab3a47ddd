#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

// Stand-ins for what ProblemNode uses of ROS 2. Messages stay where sent; clock and `spin` are the test's.
namespace rclcpp {
struct Time {
  double s = 0;
  double seconds() const { return s; }
};
struct TimerBase {
  using SharedPtr = std::shared_ptr<TimerBase>;
};
template <class Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  static inline std::vector<Message> sent{};
  void publish(const Message& message) { sent.push_back(message); }
  int get_subscription_count() const { return 1; }
};
template <class Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  static inline std::function<void(const Message&)> hear{};
};
struct SensorDataQoS {};
struct Node {
  explicit Node(const std::string&) {}
  template <class Message>
  typename Publisher<Message>::SharedPtr create_publisher(const std::string&, int) {
    return std::make_shared<Publisher<Message>>();
  }
  template <class Message, class Hear>
  typename Subscription<Message>::SharedPtr create_subscription(const std::string&, SensorDataQoS,
                                                                Hear hear) {
    Subscription<Message>::hear = hear;
    return {};
  }
  template <class Period, class Tick>
  TimerBase::SharedPtr create_wall_timer(Period, Tick act) {
    tick = act;
    return {};
  }
  int declare_parameter(const std::string& name, int value) {
    return parameters.try_emplace(name, value).first->second;
  }
  Node* get_node_base_interface() { return this; }
  Node* get_context() { return this; }
  void add_pre_shutdown_callback(std::function<void()> call) { at_end = call; }
  Node* get_clock() { return this; }
  int get_logger() const { return 0; }
  static Time now() { return time; }

  static inline std::map<std::string, int> parameters{};
  static inline std::function<void()> tick{}, at_end{};
  static inline Time time{};
  static inline std::string log{};
};
inline void init(int, char**) {}
void spin(const std::shared_ptr<Node>& node);
inline void shutdown() {}
}  // namespace rclcpp

#define RCLCPP_INFO(logger, format, words) rclcpp::Node::log = (words)
#define RCLCPP_WARN_THROTTLE(logger, clock, milliseconds, format, words) rclcpp::Node::log = (words)

namespace geometry_msgs::msg {
struct Vector3 {
  double x = 0, y = 0, z = 0;
};
struct Twist {
  Vector3 linear, angular;
};
}  // namespace geometry_msgs::msg
namespace std_msgs::msg {
struct Float64MultiArray {
  std::vector<double> data;
};
}  // namespace std_msgs::msg
namespace nav_msgs::msg {
struct Quaternion {
  double z = 0, w = 1;
};
struct PoseOfOdometry {
  struct {
    geometry_msgs::msg::Vector3 position;
    Quaternion orientation;
  } pose;
};
struct Odometry {
  struct {
    rclcpp::Time stamp;
  } header;
  PoseOfOdometry pose;
};
}  // namespace nav_msgs::msg
