// Planner and localiser of the ROS nodes: every fault stops the car with a reason, then it drives on.
#include <gtest/gtest.h>

#include "simulated_drive.hpp"

namespace slalom::nodes::testing {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Moves the odometry and its transform along x, m.
void move(Messages& m, double way) {
  m.odometry[0].pose.x += way;
  m.transforms[0].pose.x += way;
}
/// A change of the messages of each period that needs no drive.
template <class Change>
auto each(Change change) {
  return [change](Drive&, Messages& m) mutable { change(m); };
}
auto shift_scan(double time) {
  return each([=](Messages& m) { m.scans[0].stamp += stamp_of(time); });
}
auto shift_odometry(double time) {
  return each([=](Messages& m) { m.odometry[0].stamp += stamp_of(time); });
}
Fault clock_jumps(const char* name, double time) {
  return {.name = name, .reason = "clock", .begin = [=](Drive& d) { d.jump(time); }, .lasts = false};
}

std::vector<Fault> faults() {
  return {
      {"scan silent", "no scan", each([](Messages& m) { m.scans.clear(); })},
      {"scan of NaN", "", each([](Messages& m) {
         for (float& range : m.scans[0].ranges) range = std::numeric_limits<float>::quiet_NaN();
       })},
      {"scan of a wrong count", "number",
       each([](Messages& m) { m.scans[0].ranges.resize(m.scans[0].ranges.size() / 2); })},
      {"scan from the future", "future", shift_scan(5)},
      {"scan late", "late", shift_scan(-0.5)},
      {"scans out of order", "out of order", each([held = std::vector<Scan>()](Messages& m) mutable {
         if (held.empty()) return held.swap(m.scans);
         m.scans.push_back(held[0]);
         held.clear();
       })},
      {"odometry silent", "no odometry", each([](Messages& m) {
         m.odometry.clear();
         m.transforms.clear();
       })},
      {"odometry of NaN", "finite", each([](Messages& m) {
         move(m, unknown);
         m.odometry[0].speed = unknown;
       })},
      {"odometry late", "late", shift_odometry(-0.5)},
      {"odometry from the future", "future", shift_odometry(5)},
      {"odometry jumps", "jump", each([](Messages& m) {
         move(m, 3 * std::fmod(std::floor(in_seconds(m.odometry[0].stamp) / 0.2), 2));
       })},
      {"odometry of a place that no car reaches", "", each([](Messages& m) { move(m, 1e9); })},
      {"odometry of a speed that no car has", "", each([](Messages& m) { m.odometry[0].speed = 4132; })},
      {"tf missing", "tf", each([](Messages& m) { m.transforms.clear(); })},
      {"tf extrapolates", "extrapolation", each([](Messages& m) { m.transforms[0].stamp -= stamp_of(1); })},
      {"tf of NaN", "tf", each([](Messages& m) { m.transforms[0].pose.x = unknown; })},
      {"two planners", "another node commands",
       [](Drive& d, Messages&) { d.planner().hear_other_command("another"); }},
      {.name = "a map that does not match",
       .reason = "localisation",
       .begin = [](Drive& d) { d.hear_map(1.6); },
       .end = [](Drive& d) { d.hear_map(1); },
       .within = 5},  // until the localiser sees that the map does not fit
      {.name = "localiser dies",
       .reason = "tf",
       .begin = [](Drive& d) { d.end_localiser(); },
       .end = [](Drive& d) { d.start_localiser(); }},
      {"world dies", "no scan", each([](Messages& m) { m = {}; })},
      clock_jumps("clock jumps ahead", 20),
      clock_jumps("clock jumps back", -20),
  };
}

class NodeFault : public ::testing::TestWithParam<Fault> {};

TEST_P(NodeFault, StopsTheCarWithAReasonAndThenItDrivesOn) {
  const Fault& fault = GetParam();
  Drive drive;
  ASSERT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  drive.run(1.5);  // longer than a fault is remembered as the cause of others
  ASSERT_TRUE(drive.drives()) << drive.log();
  const double begin = drive.time();
  drive.begin(fault);
  if (fault.lasts) {
    EXPECT_TRUE(drive.run_until(fault.within, [&] { return drive.stops(); })) << drive.log();
    EXPECT_TRUE(drive.run_until(5, [&] { return drive.car_stands(); })) << drive.log();
    drive.run(1.5);
    EXPECT_TRUE(drive.stops()) << "must stay stopped\n" << drive.log();
  } else {
    EXPECT_TRUE(drive.run_until(fault.within, [&] { return drive.has_stopped_since(begin); })) << drive.log();
  }
  EXPECT_TRUE(drive.run_until(2, [&] { return drive.has_said(fault.reason, begin); })) << drive.log();
  drive.end();
  EXPECT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  EXPECT_EQ(drive.mistake(), "") << drive.log();
}

INSTANTIATE_TEST_SUITE_P(Each, NodeFault, ::testing::ValuesIn(faults()), [](const auto& fault) {
  std::string name = fault.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

class NodeDrive : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(drive_.run_until(30, [&] { return drive_.drives(); })) << drive_.log();
  }

  PlannerCore& planner() { return drive_.planner(); }

  Drive drive_;
};

TEST_F(NodeDrive, NothingIsAllocatedFromAScanToItsCommand) {
  drive_.run(2);
  drive_.allocations();
  drive_.run(2);
  ASSERT_TRUE(drive_.drives()) << drive_.log();
  EXPECT_EQ(drive_.allocations(), 0);
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
    drive_.end_localiser();
    ASSERT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); })) << drive_.log();
    drive_.start_localiser();
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
