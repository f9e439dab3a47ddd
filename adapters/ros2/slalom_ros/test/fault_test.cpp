// Every fault of adapters/ros2/test/faults.csv stops the car with a reason that is logged at most once per
// second, and the car continues by itself afterwards. The nodes run under the clock of this test
// (use_sim_time).
//
// usage: fault_test processes|composed FAULTS_CSV [FAULT...]
#include <algorithm>
#include <filesystem>

#include "car.hpp"
#include "nodes.hpp"

namespace slalom_ros_test {
namespace {

constexpr const char* pose_file = "fault_test_pose";  // in the working folder
const std::vector<std::string> common{"autostart:=true", "use_sim_time:=true"};

class FaultTest {
 public:
  explicit FaultTest(Nodes::Place place)
      : client_("fault_test"),
        car_(client_, "wren", 3),
        nodes_(place),
        processes_(place == Nodes::Place::processes) {
    std::filesystem::remove(pose_file);
    start("track", "track", {"course:=wren"}, {"map:=map_of_track"});
    start_localiser();
    start_planner("planner");
  }

  void run(const Fault& fault) {
    if (!processes_ && fault.change == "dies" && fault.of != "world") {
      std::printf("skipped: %s: the nodes are one process\n", fault.name.c_str());
      return;
    }
    client_.wait(
        fault.name + ": drives before", [&] { return client_.drives(); }, 60);
    client_.run(0.5);
    const double begun = steady_seconds();
    begin(fault);
    if (fault.name == "planner dies") {  // it cannot say so; the car stops without commands
      client_.wait(
          fault.name + ": the car stands", [&] { return car_.stands(); }, 5);
    } else if (fault.of == "clock") {  // it jumps once; the car continues by itself
      client_.wait(
          fault.name + ": stops", [&] { return client_.has_stopped_since(begun); }, 5);
    } else {
      client_.wait(
          fault.name + ": stops", [&] { return client_.stops(); }, 10);
      client_.wait(
          fault.name + ": the car stands", [&] { return car_.stands(); }, 5);
      client_.run(1.5);
      expect(client_.stops(), fault.name + ": does not stay stopped");
    }
    if (fault.name != "planner dies") {
      client_.wait(
          fault.name + ": reports the reason (" + fault.reason + ")",
          [&] { return !client_.reason(fault.reason, begun).empty(); }, 3);
      std::printf("   %s\n", client_.reason(fault.reason, begun).c_str());
    }
    end(fault);
    client_.wait(
        fault.name + ": drives on", [&] { return client_.drives(); }, 60);
  }

  void finish() const { client_.expect_a_reason_per_second(starts_); }

 private:
  void start(const std::string& kind, const std::string& name, std::vector<std::string> parameters,
             const std::vector<std::string>& remappings = {}) {
    parameters.insert(parameters.end(), common.begin(), common.end());
    starts_.emplace_back(steady_seconds(), name);
    nodes_.start(kind, name, parameters, remappings);
  }
  void start_localiser() { start("localiser", "localiser", {std::string("pose_file:=") + pose_file}); }
  void start_planner(const std::string& name) {
    start("planner", name, {"planner.max_speed:=3.0", "svg_mppi.samples:=500"});
  }

  void begin(const Fault& fault) {
    car_.begin(fault);
    if (fault.change == "twice") start_planner("planner2");
    if (fault.change == "dies" && fault.of != "world") nodes_.end(fault.of);
  }
  void end(const Fault& fault) {
    car_.end();
    if (fault.change == "twice") nodes_.end("planner2");
    if (fault.change == "dies" && fault.of == "localiser") start_localiser();
    if (fault.change == "dies" && fault.of == "planner") start_planner("planner");
  }

  Client client_;
  Car car_;
  Nodes nodes_;
  bool processes_;
  std::vector<std::pair<double, std::string>> starts_;  // s, steady
};

void test(int argc, char** argv) {
  expect(argc >= 3, "usage: fault_test processes|composed FAULTS_CSV [FAULT...]");
  const std::vector<std::string> chosen(argv + 3, argv + argc);
  FaultTest all(place_of(argv[1]));
  for (const Fault& fault : slalom::nodes::testing::read_faults(argv[2]))
    if (chosen.empty() || std::count(chosen.begin(), chosen.end(), fault.name) > 0) all.run(fault);
  all.finish();
}

}  // namespace
}  // namespace slalom_ros_test

int main(int argc, char** argv) try {
  rclcpp::init(1, argv);
  slalom_ros_test::test(argc, argv);
  rclcpp::shutdown();
} catch (const std::exception& error) {
  std::printf("%s\n", error.what());
  return 1;
}
