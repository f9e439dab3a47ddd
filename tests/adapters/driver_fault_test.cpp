// The ROS 2 driver with every fault of adapters/test/faults.csv that it can have: with the real localiser and
// planner, a simulated car and simulated clocks.
#include "dds/nodes/driver.hpp"
#include "faulty_drive.hpp"

namespace slalom_ros2 {
namespace {

using slalom_bridge::testing::Fault;

/// The driver, on a car whose course is known.
class DriverComputer {
 public:
  DriverComputer(const slalom_bridge::Clocks& clocks, const slalom_bridge::testing::ComputerOutputs& outputs,
                 bool map_from_topic = false)
      : driver_({.course = SLALOM_COURSES "/wren",
                 .configuration = SLALOM_CONFIGS "/default.yaml",
                 .map_from_topic = map_from_topic,
                 .set = {{"svg_mppi/samples", "500"}}},
                clocks,
                {outputs.drive, [](const Pose&) {},
                 [log = outputs.log](const std::string& line) { log("driver", line); }}) {}

  void begin(const Fault&) {}
  void end() {}
  void tick() { driver_.tick(); }
  void hear_map(const slalom_bridge::Grid& map) { driver_.hear_map(map); }
  void hear_other_command() { driver_.hear_other_command(); }
  void hear(const slalom_bridge::testing::OdometryMessage& m) {
    driver_.hear_odometry(m.stamp, m.pose, m.speed);
  }
  void hear(const slalom_bridge::testing::ScanMessage& m) {
    driver_.hear_scan(
        m.stamp, {m.ranges.data(), m.ranges.size(), m.angle_min, m.angle_increment, m.range_min, m.range_max},
        m.angle_max);
  }

 private:
  Driver driver_;
};
using Drive = slalom_bridge::testing::Drive<DriverComputer>;

/// Those that a node can have that needs no tf and is one process.
std::vector<Fault> faults_of_the_driver() {
  std::vector<Fault> faults = slalom_bridge::testing::read_faults(SLALOM_FAULTS);
  std::erase_if(faults, [](const Fault& fault) {
    return fault.of == "tf" || fault.of == "localiser" || fault.name == "planner dies";
  });
  return faults;
}

class DriverFault : public ::testing::TestWithParam<Fault> {};

TEST_P(DriverFault, StopsTheCarWithAReasonAndThenItDrivesOn) {
  slalom_bridge::testing::expect_a_stop_with_a_reason<DriverComputer>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, DriverFault, ::testing::ValuesIn(faults_of_the_driver()),
                         slalom_bridge::testing::name_of_test);

TEST(DriverMap, TheCarStandsUntilThereIsOne) {
  Drive drive(true);
  drive.run(2);
  EXPECT_TRUE(drive.stops()) << drive.log();
  EXPECT_TRUE(drive.has_said("no map yet", 0)) << drive.log();
  drive.hear_map();
  EXPECT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
}

TEST(DriverMap, OneThatComesAgainDoesNotPutTheCarBackAtTheStart) {
  Drive drive;
  ASSERT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  drive.run(3);
  ASSERT_TRUE(drive.drives()) << drive.log();
  drive.hear_map();
  drive.run(2);
  EXPECT_TRUE(drive.drives()) << drive.log();
}

}  // namespace
}  // namespace slalom_ros2
