// Simulator, localiser and planner as a client sees them: lifecycle, parameters, services, and laps among
// parked cars. The nodes are processes, or all composed in one.
//
// usage: nodes_test processes|composed
#include <filesystem>

#include <lifecycle_msgs/msg/state.hpp>
#include <lifecycle_msgs/msg/transition.hpp>
#include <lifecycle_msgs/srv/change_state.hpp>
#include <lifecycle_msgs/srv/get_state.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/path.hpp>
#include <rcl_interfaces/srv/describe_parameters.hpp>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rcl_interfaces/srv/set_parameters.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <slalom_msgs/msg/planner_metrics.hpp>
#include <slalom_msgs/srv/drive_laps.hpp>
#include <slalom_msgs/srv/save.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_srvs/srv/empty.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "nodes.hpp"

namespace slalom_ros_test {
namespace {

using lifecycle_msgs::msg::State;
using lifecycle_msgs::msg::Transition;
using lifecycle_msgs::srv::ChangeState;
using lifecycle_msgs::srv::GetState;
using rcl_interfaces::srv::DescribeParameters;
using rcl_interfaces::srv::GetParameters;
using rcl_interfaces::srv::SetParameters;
using sensor_msgs::msg::LaserScan;
using slalom_msgs::srv::DriveLaps;
using slalom_msgs::srv::Save;
using std_msgs::msg::Int32;
using visualization_msgs::msg::MarkerArray;

class NodeTest {
 public:
  explicit NodeTest(const std::string& place) : nodes_(place) {
    nodes_.start("world", "world", {"autostart:=true", "course:=wren", "obstacles:=5"});
    nodes_.start("localiser", "localiser", {"autostart:=true", "course:=wren", "everywhere:=true"});
    nodes_.start("planner", "planner", {"course:=wren", "svg_mppi.samples:=2000"});
    nodes_.start("planner", "wrong", {"planner.max_sped:=1.0"});
    nodes_.start("planner", "wild", {"svg_mppi.samples:=-5"});
  }

  void lifecycle_until_it_drives() {
    expect(state("planner") == State::PRIMARY_STATE_UNCONFIGURED, "without autostart a node is unconfigured");
    expect(change("planner", Transition::TRANSITION_CONFIGURE), "configure");
    expect(state("planner") == State::PRIMARY_STATE_INACTIVE, "then it is inactive");
    client_.run(1);
    expect(client_.commanded_at == 0, "an inactive planner sends no commands");
    expect(change("planner", Transition::TRANSITION_ACTIVATE), "activate");
    client_.wait("the active planner drives", 60, [&] { return client_.drives(); });
  }

  void speed_limit() {
    client_.run(5);
    expect(number("planner.max_speed") == 1, "planner.max_speed is 1 m/s if nobody sets it");
    expect(client_.speed <= 1.01, "the car drives at most 1 m/s");
  }

  void parameters() {
    const auto described = describe("planner.max_speed");
    expect(!described.description.empty(), "a parameter has a description");
    expect(described.additional_constraints.find("must be") != std::string::npos, "and its rule");
    expect(set("planner.max_speed", rclcpp::ParameterValue(2.5)).successful, "it can change while driving");
    client_.wait("the car drives faster than 1 m/s", 20, [&] { return client_.speed > 1.2; });
    const auto refused = set("planner.max_speed", rclcpp::ParameterValue(-3.0));
    expect(!refused.successful && refused.reason.find("must be") != std::string::npos,
           "a value out of range is refused with the rule");
    std::printf("   %s\n", refused.reason.c_str());
    expect(number("planner.max_speed") == 2.5, "then it is unchanged");
    expect(!set("svg_mppi.none", rclcpp::ParameterValue(1.0)).successful, "an unknown one is refused");
    const auto choice = set("vehicle.model", rclcpp::ParameterValue(std::string("boat")));
    expect(!choice.successful && choice.reason.find("boat") != std::string::npos, "a choice states its rule");
    std::printf("   %s\n", choice.reason.c_str());
    client_.run(1);
    expect(client_.drives(), "the car drives on");
  }

  void wrong_parameters() {
    for (const char* name : {"wrong", "wild"}) {
      expect(!change(name, Transition::TRANSITION_CONFIGURE), std::string(name) + " cannot be configured");
      expect(state(name) == State::PRIMARY_STATE_UNCONFIGURED, "it stays unconfigured");
      nodes_.end(name);
    }
  }

  void laps() {
    expect(set("planner.max_speed", rclcpp::ParameterValue(100.0)).successful, "full speed");
    expect(!ask_for_laps(-1), "a negative number of laps is refused");
    expect(ask_for_laps(3), "three laps are asked for");
    const int collisions = collisions_->back().data;
    const double begin = steady_seconds();
    client_.wait("after three laps the car stops", 270,
                 [&] { return client_.has_said("all laps are driven", begin) && client_.stops(); });
    expect(laps_->back().data >= 3, "the simulator has counted the laps");
    expect(collisions_->back().data == collisions, "no collisions");
    expect(!map_->empty() && !path_->empty(), "a map and a path");
    expect(!parked_->empty() && !plan_->empty(), "markers of parked cars, and plans");
    expect(plans_->size() > scans_->size() / 2, "plans for most scans");
    expect(client_.diagnostics["planner: plans"].count("latency from scan to command, p99, ms") > 0 &&
               client_.diagnostics["localiser: localisation"].count("health") > 0 &&
               client_.diagnostics["world: simulated car"].count("laps") > 0,
           "diagnostics of each node");
    expect(ask_for_laps(0), "laps without end");
    client_.wait("it drives on", 20, [&] { return client_.drives(); });
  }

  void saves_its_options() {
    const std::string file = std::filesystem::temp_directory_path() / "slalom_ros_node_test.yaml";
    Save::Request save;
    save.file = file;
    expect(client_.call<Save>("/planner/save", save)->success, "the options are saved");
    expect(std::filesystem::file_size(file) > 1000, "the file has the options");
    std::filesystem::remove(file);
    save.file = "/none/at/all.yaml";
    expect(!client_.call<Save>("/planner/save", save)->success, "a file that cannot be written is an error");
    client_.call<std_srvs::srv::Empty>("/reset");
  }

  void lifecycle_to_the_end() {
    client_.wait("the car drives after the reset", 60, [&] { return client_.drives(); });
    expect(change("planner", Transition::TRANSITION_DEACTIVATE), "deactivate");
    expect(client_.speed == 0, "the last command is to stop");
    const double at = client_.commanded_at;
    client_.run(1);
    expect(client_.commanded_at <= at + 0.1, "an inactive planner sends no commands");
    expect(change("planner", Transition::TRANSITION_CLEANUP), "cleanup");
    expect(change("planner", Transition::TRANSITION_CONFIGURE), "configure again");
    expect(change("planner", Transition::TRANSITION_ACTIVATE), "activate again");
    client_.wait("it drives again", 60, [&] { return client_.drives(); });
    expect(change("planner", Transition::TRANSITION_ACTIVE_SHUTDOWN), "shutdown");
    expect(state("planner") == State::PRIMARY_STATE_FINALIZED, "then it is finalized");
  }

 private:
  unsigned state(const std::string& name) {
    return client_.call<GetState>("/" + name + "/get_state")->current_state.id;
  }
  bool change(const std::string& name, unsigned char transition) {
    ChangeState::Request request;
    request.transition.id = transition;
    const bool changed = client_.call<ChangeState>("/" + name + "/change_state", request)->success;
    client_.run(0.2);
    return changed;
  }
  bool ask_for_laps(int laps) {
    DriveLaps::Request request;
    request.laps = laps;
    return client_.call<DriveLaps>("/planner/drive_laps", request)->success;
  }
  rcl_interfaces::msg::SetParametersResult set(const std::string& name, const rclcpp::ParameterValue& value) {
    SetParameters::Request request;
    request.parameters.push_back(rclcpp::Parameter(name, value).to_parameter_msg());
    return client_.call<SetParameters>("/planner/set_parameters", request)->results.at(0);
  }
  double number(const std::string& name) {
    GetParameters::Request request;
    request.names = {name};
    return client_.call<GetParameters>("/planner/get_parameters", request)->values.at(0).double_value;
  }
  rcl_interfaces::msg::ParameterDescriptor describe(const std::string& name) {
    DescribeParameters::Request request;
    request.names = {name};
    return client_.call<DescribeParameters>("/planner/describe_parameters", request)->descriptors.at(0);
  }

  const rclcpp::QoS some_{50}, latched_ = rclcpp::QoS(1).transient_local();
  Client client_{"nodes_test"};
  template <class Message>
  using Recorded = std::shared_ptr<const std::vector<Message>>;
  Recorded<LaserScan> scans_ = client_.record<LaserScan>("scan", rclcpp::SensorDataQoS());
  Recorded<Int32> collisions_ = client_.record<Int32>("collisions", some_);
  Recorded<Int32> laps_ = client_.record<Int32>("laps", some_);
  Recorded<slalom_msgs::msg::PlannerMetrics> plans_ =
      client_.record<slalom_msgs::msg::PlannerMetrics>("mppi/eval_metrics", some_);
  Recorded<nav_msgs::msg::OccupancyGrid> map_ = client_.record<nav_msgs::msg::OccupancyGrid>("map", latched_);
  Recorded<nav_msgs::msg::Path> path_ = client_.record<nav_msgs::msg::Path>("reference_path", latched_);
  Recorded<MarkerArray> parked_ = client_.record<MarkerArray>("obstacles", latched_);
  Recorded<nav_msgs::msg::Path> plan_ = client_.record<nav_msgs::msg::Path>("plan", some_);
  Nodes nodes_;
};

void test(const std::string& place) {
  NodeTest all(place);
  all.lifecycle_until_it_drives();
  all.speed_limit();
  all.parameters();
  all.wrong_parameters();
  all.laps();
  all.saves_its_options();
  all.lifecycle_to_the_end();
}

}  // namespace
}  // namespace slalom_ros_test

int main(int argc, char** argv) {
  return slalom_ros_test::run_test(argc, argv, &slalom_ros_test::test);
}
