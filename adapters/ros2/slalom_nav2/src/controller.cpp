#include "controller.hpp"

#include <exception>

#include <nav2_core/controller_exceptions.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <pluginlib/class_loader.hpp>
#include <slalom_msgs/msg/cost_terms.hpp>
#include <visualization_msgs/msg/marker.hpp>

#include "option_parameters.hpp"
#include "slalom_nav2/cost_term.hpp"
#include "tracked_objects.hpp"

namespace slalom_nav2 {
namespace {

using slalom::maps::Pose;
using slalom::nodes::FollowerAnswer;
using slalom::nodes::GoalTolerance;

/// A tolerance of a goal checker, or 0 if it does not measure that: then it tells 0 or no sensible value.
double tolerance(double told) {
  return std::isfinite(told) && told > 0 && told < 1e6 ? told : 0;
}
std::optional<GoalTolerance> tolerance_of(nav2_core::GoalChecker* checker) {
  geometry_msgs::msg::Pose pose;
  if (checker == nullptr || !get_tolerances(*checker, pose)) return {};
  return GoalTolerance{tolerance(std::min(pose.position.x, pose.position.y)),
                       tolerance(slalom_ros::yaw_of(pose.orientation))};
}

/// A parameter that is fixed once the controller is configured.
std::string setting(Controller::Node& node, const std::string& name, const std::string& value,
                    const char* description) {
  if (!node.has_parameter(name))
    node.declare_parameter<std::string>(name, value, slalom_ros::fixed(description));
  return node.get_parameter(name).as_string();
}

/// Adds the plugins of `cost_plugins` in their order, each under its name.
void add_costs(Controller::Node& node, const std::string& prefix, slalom::nodes::PathFollower& follower) {
  const auto loader =
      std::make_shared<pluginlib::ClassLoader<CostTerm>>("slalom_nav2", "slalom_nav2::CostTerm");
  const std::string names = prefix + "cost_plugins";
  if (!node.has_parameter(names)) node.declare_parameter(names, std::vector<std::string>{});
  for (const std::string& name : node.get_parameter(names).as_string_array()) {
    const std::string section = prefix + name + ".";
    const auto term =
        loader->createSharedInstance(setting(node, section + "plugin", "", "class of the term"));
    term->configure(node, section);
    follower.add_cost(name, [loader, term](const auto& states, std::span<double> costs) {
      term->add(states, costs);  // the loader keeps its code
    });
  }
}

}  // namespace

/// The messages for displays.
struct Controller::Outputs {
  template <class Message>
  using Publisher = std::shared_ptr<rclcpp_lifecycle::LifecyclePublisher<Message>>;
  Publisher<nav_msgs::msg::Path> plan, path;
  Publisher<slalom_msgs::msg::CostTerms> terms;
  Publisher<visualization_msgs::msg::Marker> samples;

  template <class Act>
  void for_each(Act act) {
    act(*plan), act(*path), act(*terms), act(*samples);
  }
  void publish(const slalom::nodes::PathFollower& follower, const std::string& frame,
               const rclcpp::Time& time) {
    plan->publish(slalom_ros::path_of(follower.predicted(), frame, time.nanoseconds()));
    path->publish(slalom_ros::path_of(follower.path(), frame, time.nanoseconds()));
    slalom_msgs::msg::CostTerms cost;
    cost.header.stamp = time;
    for (const slalom::CostTerm& term : follower.cost_terms()) {
      cost.names.emplace_back(term.name);
      cost.costs.push_back(term.value);
    }
    terms->publish(cost);
    if (samples->get_subscription_count() == 0) return;
    visualization_msgs::msg::Marker lines;
    lines.header.frame_id = frame;
    lines.header.stamp = time;
    lines.type = visualization_msgs::msg::Marker::LINE_LIST;
    lines.pose.orientation.w = 1;
    lines.scale.x = 0.01;
    lines.color.b = lines.color.a = 0.7F;
    for (const auto& [x, y] : follower.samples(100))
      lines.points.push_back(slalom_ros::message_of(Pose{x, y, 0}).position);
    samples->publish(lines);
  }
};

void Controller::configure(const ServerNode::WeakPtr& parent, std::string name,
                           std::shared_ptr<tf2_ros::Buffer> transforms,
                           std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap) {
  const std::shared_ptr<Node> node = parent.lock();
  if (!node) throw nav2_core::ControllerException("the node of the controller is gone");
  clock_ = node->get_clock();
  logger_ = node->get_logger();
  transforms_ = std::move(transforms);
  costmap_ = std::move(costmap);

  const std::string prefix = name + ".";
  follower_ = std::make_unique<slalom::nodes::PathFollower>(
      setting(*node, prefix + "method", "svg_mppi", "method that plans; `slalom options` lists them"));
  add_costs(*node, prefix, *follower_);
  parameters_ = std::make_shared<slalom_ros::OptionParameters>(
      *node,
      [this] {
        const std::lock_guard<std::mutex> lock(mutex_);
        return follower_->options();
      },
      [this](const slalom::nodes::Changes& changes) {
        const std::lock_guard<std::mutex> lock(mutex_);
        follower_->change(changes);
      },
      prefix);
  for (const std::string& unused : parameters_->unused())
    RCLCPP_WARN(logger_, "parameter %s has no meaning for this controller", unused.c_str());
  outputs_ = std::make_shared<Outputs>(
      Outputs{node->create_publisher<nav_msgs::msg::Path>("local_plan", 1),
              node->create_publisher<nav_msgs::msg::Path>("transformed_global_plan", 1),
              node->create_publisher<slalom_msgs::msg::CostTerms>("cost_terms", 1),
              node->create_publisher<visualization_msgs::msg::Marker>("candidate_trajectories", 1)});
  subscribe(*node, prefix);
}

/// Listens to people, as the option `others` says.
void Controller::subscribe(Node& node, const std::string& prefix) {
  using slalom::nodes::OthersFrom;
  const auto topic = [&](const char* name) {
    return setting(node, prefix + name + "_topic", name, "used by the option `others`");
  };
  const auto hear = [this](OthersFrom from, const auto& m, const auto& take) {
    try {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (follower_ && follower_->others_from() == from)
        take(frame_in_costmap(m.header.frame_id, m.header.stamp), rclcpp::Time(m.header.stamp).seconds());
    } catch (const std::exception& error) {
      RCLCPP_WARN_ONCE(logger_, "people were ignored: %s", error.what());
    }
  };
  scans_ = node.create_subscription<sensor_msgs::msg::LaserScan>(
      topic("scan"), rclcpp::SensorDataQoS(), [this, hear](const sensor_msgs::msg::LaserScan& m) {
        hear(OthersFrom::scan, m, [&](const Pose& sensor, double stamp) {
          follower_->people().see({.scan = slalom_ros::scan_of(m), .sensor = sensor, .stamp = stamp});
        });
      });
  objects_ = node.create_subscription<slalom_msgs::msg::TrackedObjects>(
      topic("tracked_objects"), rclcpp::SensorDataQoS(),
      [this, hear](const slalom_msgs::msg::TrackedObjects& m) {
        hear(OthersFrom::topic, m, [&](const Pose& frame, double stamp) {
          follower_->people().hear(slalom_ros::objects_of(m, frame), stamp);
        });
      });
}

void Controller::cleanup() {
  // The parameters call back and take the lock, so they end first, without it.
  parameters_.reset();
  scans_.reset();
  objects_.reset();
  const std::lock_guard<std::mutex> lock(mutex_);
  follower_.reset();
  outputs_.reset();
  costmap_.reset();
  transforms_.reset();
  clock_.reset();
}

void Controller::activate() {
  outputs_->for_each([](auto& each) { each.on_activate(); });
}

void Controller::deactivate() {
  outputs_->for_each([](auto& each) { each.on_deactivate(); });
}

void Controller::use_plan(const nav_msgs::msg::Path& plan) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (plan.header.frame_id.empty()) throw nav2_core::InvalidPath("path: its frame has no name");
  std::vector<Pose> poses;
  for (const auto& stamped : plan.poses) poses.push_back(slalom_ros::pose_of(stamped.pose));
  try {
    follower_->use_plan(poses);
  } catch (const std::exception& error) {
    throw nav2_core::InvalidPath(error.what());
  }
  plan_frame_ = plan.header.frame_id;
}

/// Returns the pose of a frame in the frame of the costmap. Throws nav2_core::ControllerTFError.
Pose Controller::frame_in_costmap(const std::string& frame, const rclcpp::Time& time) const {
  const std::string costmap = costmap_->getGlobalFrameID();
  if (frame == costmap || frame.empty()) return {};
  try {
    return slalom_ros::mount_of(transforms_
                                    ->lookupTransform(costmap, frame, tf2_ros::fromRclcpp(time),
                                                      tf2::durationFromSec(follower_->transform_tolerance()))
                                    .transform)
        .planar();
  } catch (const tf2::TransformException& error) {
    throw nav2_core::ControllerTFError(error.what());
  }
}

void Controller::read_costmap() try {
  const std::vector<geometry_msgs::msg::Point> footprint = costmap_->getRobotFootprint();
  std::vector<slalom::maps::Point> vertices;
  for (const auto& point : footprint) vertices.push_back({point.x, point.y});
  follower_->use_footprint(vertices);

  nav2_costmap_2d::Costmap2D& costmap = *costmap_->getCostmap();
  const std::lock_guard<nav2_costmap_2d::Costmap2D::mutex_t> lock(*costmap.getMutex());
  follower_->use_costmap({static_cast<int>(costmap.getSizeInCellsX()),
                          static_cast<int>(costmap.getSizeInCellsY()), costmap.getResolution(),
                          costmap.getOriginX(), costmap.getOriginY(), costmap.getCharMap()});
} catch (const std::exception& error) {
  throw nav2_core::ControllerException(error.what());
}

geometry_msgs::msg::TwistStamped Controller::command(const geometry_msgs::msg::PoseStamped& pose,
                                                     const geometry_msgs::msg::Twist& velocity,
                                                     nav2_core::GoalChecker* goal_checker) {
  const std::lock_guard<std::mutex> lock(mutex_);
  read_costmap();
  slalom::nodes::FollowerInput input;
  input.pose = slalom::nodes::composed(frame_in_costmap(pose.header.frame_id, pose.header.stamp),
                                       slalom_ros::pose_of(pose.pose));
  input.plan_frame = frame_in_costmap(plan_frame_, pose.header.stamp);
  input.velocity = {velocity.linear.x, velocity.linear.y, velocity.angular.z};
  input.time = clock_->now().seconds();
  input.tolerance = tolerance_of(goal_checker);
  const FollowerAnswer answer = follower_->update(input);
  if (follower_->visualizes()) outputs_->publish(*follower_, costmap_->getGlobalFrameID(), pose.header.stamp);
  if (answer.problem == FollowerAnswer::Problem::invalid_path) throw nav2_core::InvalidPath(answer.why);
  if (answer.problem == FollowerAnswer::Problem::no_control) throw nav2_core::NoValidControl(answer.why);

  geometry_msgs::msg::TwistStamped sent;
  sent.header.stamp = pose.header.stamp;
  sent.header.frame_id = costmap_->getBaseFrameID();
  sent.twist.linear.x = answer.command.forward;
  sent.twist.linear.y = answer.command.left;
  sent.twist.angular.z = answer.command.turn;
  return sent;
}

bool Controller::cancel() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return follower_->cancel();
}

void Controller::setSpeedLimit(const double& limit, const bool& percentage) {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    follower_->limit_speed(limit, percentage);
  } catch (const std::exception& error) {
    RCLCPP_ERROR(logger_, "not changed: %s", error.what());
  }
}

void Controller::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  follower_->reset();
}

}  // namespace slalom_nav2

PLUGINLIB_EXPORT_CLASS(slalom_nav2::Controller, nav2_core::Controller)
