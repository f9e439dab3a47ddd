// Planner and localiser of the ROS nodes, without their transport, with every fault of faults.csv:
// with a simulated car, simulated clocks, and a stand-in for tf2.
#include "faulty_drive.hpp"

namespace slalom::nodes::testing {
namespace {

std::vector<Fault> faults_of_the_nodes() {
  std::vector<Fault> faults = read_faults(SLALOM_FAULTS);
  std::erase_if(faults, [](const Fault& fault) { return fault.name == "planner dies"; });
  return faults;
}

class NodeFault : public ::testing::TestWithParam<Fault> {};

TEST_P(NodeFault, StopsTheCarWithAReasonAndThenItDrivesOn) {
  expect_a_stop_with_a_reason(GetParam());
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, NodeFault, ::testing::ValuesIn(faults_of_the_nodes()), name_of_test);

class NodeDrive : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(drive_.run_until(30, [&] { return drive_.drives(); })) << drive_.log();
  }

  PlannerCore& planner() { return drive_.computer().planner(); }

  Drive drive_;
};

TEST_F(NodeDrive, NothingIsAllocatedFromAScanToItsCommand) {
  drive_.run(2);
  drive_.computer().allocations();
  drive_.run(2);
  ASSERT_TRUE(drive_.drives()) << drive_.log();
  EXPECT_EQ(drive_.computer().allocations(), 0);
}

TEST_F(NodeDrive, EndsAfterTheNumberOfLaps) {
  EXPECT_THROW(planner().drive_laps(-1), std::exception);
  planner().drive_laps(1);
  const double begin = drive_.time();
  EXPECT_TRUE(drive_.run_until(60, [&] { return drive_.has_said("all laps are driven", begin); }))
      << drive_.log();
  EXPECT_GT(drive_.time() - begin, 5) << "a lap takes longer";
  EXPECT_EQ(planner().laps(), 1);
  EXPECT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); }));
  planner().drive_laps(0);
  EXPECT_TRUE(drive_.run_until(10, [&] { return drive_.drives(); })) << drive_.log();
}

/// The car stops metres from the place that was kept, and parked cars hide walls there.
TEST_F(NodeDrive, ALocaliserThatIsRestartedContinuesWhereverTheCarStops) {
  for (int k = 0; k < 4; ++k) {
    drive_.run(1.1 + 0.14 * k);
    drive_.begin({.name = "localiser dies", .of = "localiser", .change = "dies", .value = 0, .reason = "tf"});
    ASSERT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); })) << drive_.log();
    drive_.end();
    ASSERT_TRUE(drive_.run_until(3, [&] { return drive_.drives(); })) << k << ": " << drive_.log();
  }
}

TEST_F(NodeDrive, AGoalSpeedOfZeroStopsTheCarAndALowOneSlowsIt) {
  planner().hear_goal_speed(0);
  EXPECT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); }));
  EXPECT_TRUE(drive_.has_said("goal speed is 0", 0)) << drive_.log();
  planner().hear_goal_speed(0.8);
  EXPECT_TRUE(drive_.run_until(10, [&] { return drive_.drives(); })) << drive_.log();
  drive_.run(2);
  EXPECT_LE(drive_.speed(), 0.9);
}

TEST_F(NodeDrive, ReportsPlansAndLatency) {
  planner().report();
  drive_.run(1);
  const Report report = planner().report();
  EXPECT_EQ(report.about, "plans");
  EXPECT_EQ(report.message, "driving");
  const auto value = [&](const std::string& key) {
    for (const auto& [name, text] : report.values)
      if (name == key) return std::stod(text);
    ADD_FAILURE() << "there is no " << key;
    return 0.0;
  };
  EXPECT_NEAR(value("plans"), 40, 2);
  EXPECT_EQ(value("stops"), 0);
  EXPECT_GE(value("latency from scan to command, p99, ms"), value("latency from scan to command, p50, ms"));
  EXPECT_LT(value("latency from scan to command, p99, ms"), 25) << "of the simulated clock";
}

TEST_F(NodeDrive, AnImuThatTfDoesNotKnowIsReportedOnce) {
  const double begin = drive_.time();
  for (int i = 0; i < 100; ++i) {
    planner().hear_imu({"unknown", {0, 0, 0}, {0, 0, 0}});
    drive_.run(0.025);
  }
  EXPECT_EQ(drive_.count_said("imu is not used", begin), 1) << drive_.log();
  EXPECT_TRUE(drive_.drives()) << drive_.log();
}

}  // namespace
}  // namespace slalom::nodes::testing
