// A course: publishes its map as `map` and its path as `reference_waypoint`, once; later subscribers receive
// them, too.
#include <optional>

#include <rclcpp_components/register_node_macro.hpp>
#include <slalom_msgs/msg/waypoints.hpp>

#include "conversions.hpp"
#include "logic/installed.hpp"
#include "managed_node.hpp"

namespace slalom_ros {

using nav_msgs::msg::OccupancyGrid;
using rclcpp_lifecycle::LifecyclePublisher;
using slalom_msgs::msg::Waypoints;

class TrackNode : public ManagedNode {
 public:
  explicit TrackNode(const rclcpp::NodeOptions& options)
      : ManagedNode("track", options, std::chrono::milliseconds(1000)),
        name_(setting<std::string>("course", "wren", "a name or a folder")),
        frame_(setting<std::string>("map_frame", "map", "frame of map and path")) {}

 protected:
  void set_up() override {
    course_ = nodes::load_course(name_);
    map_out_ = latched_publisher<OccupancyGrid>("map");
    waypoints_out_ = latched_publisher<Waypoints>("reference_waypoint");
  }

  void start() override {
    OccupancyGrid map = message_of(course_->map, frame_);
    map.header.stamp = now();
    map_out_->publish(map);
    Waypoints path;
    path.header = map.header;
    for (const auto& w : course_->waypoints) {
      path.poses.push_back(message_of(Pose{w.x, w.y, w.yaw}));
      path.speeds.push_back(w.speed);
    }
    waypoints_out_->publish(path);
  }

  void stop() override {}

  void tear_down() override {
    course_.reset();
    map_out_.reset();
    waypoints_out_.reset();
  }

  nodes::Report report() override {
    nodes::Report r;
    r.about = "course";
    r.message = course_->name;
    r.add("waypoints", course_->waypoints.size());
    r.add("closed", course_->closed ? "yes" : "no");
    return r;
  }

 private:
  std::string name_, frame_;
  std::optional<slalom::vehicle::Course> course_;
  std::shared_ptr<LifecyclePublisher<OccupancyGrid>> map_out_;
  std::shared_ptr<LifecyclePublisher<Waypoints>> waypoints_out_;
};

}  // namespace slalom_ros

RCLCPP_COMPONENTS_REGISTER_NODE(slalom_ros::TrackNode)
