#pragma once

#include <chrono>

#include <rclcpp/rclcpp.hpp>
#include <slalom/view/monitor.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>

namespace slalom_ros {

/// Commands of a controller from the newest state of a robot, without ROS. Once constructed, `hear` and
/// `command` do not allocate or throw.
template <slalom::Problem P>
class CommandLoop {
 public:
  using State = typename slalom::Controller<P>::State;    ///< state of the problem
  using Inputs = typename slalom::Controller<P>::Inputs;  ///< inputs of a step

  struct Options {
    /// Sent without a state that is new enough, without an answer of the solver, and where all samples and
    /// the plan collide.
    Inputs safe{};
    double timeout = 0.1;    ///< s, from which age on a state is too old
    double deadline = 0.01;  ///< s, that a solve may take
  };

  CommandLoop(slalom::Controller<P> controller, const Options& options)
      : controller_(std::move(controller)), options_(options) {}

  /// Takes the state at a time (s).
  void hear(const State& state, double stamp) noexcept {
    state_ = state;
    stamp_ = stamp;
  }
  /// Returns the inputs for a time (s).
  Inputs command(double now) noexcept {
    plan_.reset();
    age_ = now - stamp_;
    if (!state_ || !(age_ >= -latest && age_ <= options_.timeout)) return options_.safe;
    const bool can_shift = solved_ && controller_.evaluator().time_step() > 0;
    const double elapsed = can_shift ? std::max(now - *solved_, 0.0) : 0;
    plan_.emplace(controller_.solve(*state_, {.elapsed = elapsed, .deadline = options_.deadline}));
    solved_ = now;
    return is_trusted() ? plan_->inputs[0] : options_.safe;
  }

  /// Returns the reason for which the last command was `safe`; empty if it was not.
  std::string why() const {
    if (!state_) return "no state yet";
    if (!plan_) return "the newest state is " + std::to_string(age_) + " s old";
    return is_trusted() ? "" : slalom::name(plan_->status);
  }
  /// The plan of the last command, if there is one.
  const std::optional<slalom::Plan<P>>& plan() const noexcept { return plan_; }
  const slalom::Controller<P>& controller() const noexcept { return controller_; }

 private:
  static constexpr double latest = 0.05;  ///< s, that the stamp of a state may be in the future

  bool is_trusted() const noexcept {
    using slalom::Status;
    const Status status = plan_->status;
    return status == Status::ok || status == Status::deadline ||
           (status == Status::all_collided && !plan_->collided);
  }

  slalom::Controller<P> controller_;
  Options options_;
  std::optional<State> state_;
  std::optional<slalom::Plan<P>> plan_;
  std::optional<double> solved_;  ///< s
  double stamp_ = 0, age_ = 0;    ///< s
};

/// A node for a problem of your own: states from a topic, commands and plans (`~/plan`: the states, step by
/// step) to topics. Its parameter `view_port` serves the page of the live view; 0: none.
template <class StateMessage, class CommandMessage, slalom::Problem P>
class ProblemNode : public rclcpp::Node {
 public:
  using Loop = CommandLoop<P>;

  struct Settings {
    std::string state_topic{}, command_topic{};
    /// Returns the state of a message, whose time is that of its header, or else of its arrival.
    std::function<typename Loop::State(const StateMessage&)> state{};
    std::function<CommandMessage(const typename Loop::Inputs&)>
        command{};  ///< returns the message for inputs
    typename Loop::Options loop{};
    double period = 0.05;                               ///< s, between two commands
    std::optional<slalom::view::Drawing<P>> drawing{};  ///< the page shows the problem by it
  };

  ProblemNode(const std::string& name, slalom::Controller<P> controller, Settings settings)
      : Node(name), settings_(std::move(settings)), loop_(std::move(controller), settings_.loop) {
    commands_ = create_publisher<CommandMessage>(settings_.command_topic, 1);
    plans_ = create_publisher<std_msgs::msg::Float64MultiArray>("~/plan", 1);
    states_ = create_subscription<StateMessage>(settings_.state_topic, rclcpp::SensorDataQoS(),
                                                [this](const StateMessage& m) { hear(m); });
    timer_ = create_wall_timer(std::chrono::duration<double>(settings_.period), [this] { tick(); });
    get_node_base_interface()->get_context()->add_pre_shutdown_callback(
        [this] { commands_->publish(settings_.command(settings_.loop.safe)); });
    const int port = declare_parameter("view_port", 0);
    if (port == 0) return;
    if (port < 0 || port > 65535 || !settings_.drawing)
      throw std::invalid_argument("view_port: must be in [0, 65535], and the node needs a drawing");
    page_.emplace(loop_.controller(), *settings_.drawing,
                  slalom::view::ServeOptions{.port = static_cast<std::uint16_t>(port)});
    RCLCPP_INFO(get_logger(), "the live view is at %s", page_->address().c_str());
  }

 private:
  double now_in_seconds() { return get_clock()->now().seconds(); }

  void hear(const StateMessage& m) {
    double stamp = now_in_seconds();
    if constexpr (requires { m.header.stamp; }) stamp = rclcpp::Time(m.header.stamp).seconds();
    loop_.hear(settings_.state(m), stamp);
  }

  void tick() {
    commands_->publish(settings_.command(loop_.command(now_in_seconds())));
    if (const std::string why = loop_.why(); !why.empty())
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "stopping: %s", why.c_str());
    if (!loop_.plan()) return;
    if (page_) page_->show(loop_.controller(), *loop_.plan());
    if (plans_->get_subscription_count() == 0) return;
    const auto states = loop_.plan()->states;
    const auto* const values = reinterpret_cast<const double*>(states.data());
    std_msgs::msg::Float64MultiArray message;
    message.data.assign(values, values + states.size_bytes() / sizeof(double));
    plans_->publish(message);
  }

  Settings settings_;
  Loop loop_;
  std::optional<slalom::view::Monitor<P>> page_;
  typename rclcpp::Publisher<CommandMessage>::SharedPtr commands_;
  rclcpp::Publisher<std_msgs::msg::Float64MultiArray>::SharedPtr plans_;
  typename rclcpp::Subscription<StateMessage>::SharedPtr states_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace slalom_ros
