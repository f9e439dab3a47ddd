// Planner and localiser of the ROS nodes, without their transport, with every fault of
// adapters/test/faults.csv: with a simulated car, simulated clocks, and a stand-in for tf2.
#include "bridge/localiser_core.hpp"
#include "bridge/planner_core.hpp"
#include "faulty_drive.hpp"
#include "support/allocations.hpp"
#include "transform_history.hpp"

namespace slalom_bridge::testing {
namespace {

constexpr const char* wren = SLALOM_COURSES "/wren";

/// Both nodes, and the transforms that they and the car publish.
class NodeComputer {
 public:
  NodeComputer(const Clocks& clocks, const ComputerOutputs& outputs)
      : clocks_(clocks), outputs_(outputs), laser_(World(wren, 1, 0).laser()), planner_(make_planner()) {
    planner_.change({{"svg_mppi/samples", "500"}});
    planner_.use_course();
    start_localiser({});
  }

  void begin(const Fault& fault) {
    fault_ = fault;
    if (!has("localiser", "dies")) return;
    localiser_.reset();
  }
  void end() {
    if (has("localiser", "dies")) start_localiser(kept_);
    fault_.reset();
  }

  void tick() {
    if (localiser_) localiser_->tick();
    // The nodes keep it with each report.
    if (localiser_ && ++ticks_ % std::lround(1 / period) == 0) kept_ = localiser_->reliable();
    count_allocations([this] { planner_.tick(); });
  }
  void hear_map(const Grid& map) { localiser_->hear_map(map); }
  void hear_other_command() { planner_.hear_other_command("another"); }

  void hear(const OdometryMessage& m) {
    const Stamp stamp = stamp_of(m.stamp);
    // A fault of the odometry's stamps is none of the transforms.
    const Stamp shift = has("odometry", "stamp") ? -stamp_of(fault_->value) : 0;
    const Stamp shift_of_tf = has("tf", "stamp") ? stamp_of(fault_->value) : 0;
    if (!has("tf", "silent") && !has("tf", "not a number"))
      odometry_to_base_.add(stamp + shift + shift_of_tf, m.pose);
    if (localiser_) localiser_->hear_odometry({stamp, m.pose, m.speed, m.yaw_rate});
    planner_.hear_odometry(stamp, m.speed);
  }
  void hear(const ScanMessage& m) {
    const Scan scan{m.ranges.data(),   m.ranges.size(), m.angle_min,
                    m.angle_increment, m.range_min,     m.range_max};
    count_allocations([&] { planner_.hear_scan(stamp_of(m.stamp), "laser", scan, m.angle_max); });
    if (localiser_) localiser_->hear_scan(stamp_of(m.stamp), "laser", scan, m.angle_max);
    count_allocations([&] { planner_.tick(); });
  }

  PlannerCore& planner() { return planner_; }
  /// Of the planner, from a scan to its command, since the last call.
  long allocations() { return std::exchange(allocations_, 0); }

 private:
  bool has(const char* of, const char* change) const {
    return fault_ && fault_->of == of && fault_->change == change;
  }

  template <class Action>
  void count_allocations(Action&& action) {
    const long before = slalom::testing::allocations();
    allocations_of_outputs_ = 0;
    action();
    allocations_ += slalom::testing::allocations() - before - allocations_of_outputs_;
  }

  Frames frames() {
    return {[this](Stamp at) { return map_to_odometry_.knows(at) && odometry_to_base_.knows(at); },
            [this](Stamp at) { return composed(map_to_odometry_.at(at), odometry_to_base_.at(at)); },
            [this](const std::string& frame) {
              if (frame == "unknown") throw std::runtime_error("there is no transform");
              return mount_of(laser_.x, laser_.y, 0, 0, 0, 0, 1);
            },
            [this] {
              map_to_odometry_.clear();
              odometry_to_base_.clear();
            }};
  }

  PlannerCore make_planner() {
    PlannerCore::Settings settings;
    settings.configuration = SLALOM_CONFIGS "/default.yaml";
    settings.course = wren;
    const auto log = [this](const std::string& line) { outputs_.log("planner", line); };
    return {settings,
            clocks_,
            frames(),
            {[this](double steer, double speed) {
               const long before = slalom::testing::allocations();
               outputs_.drive(steer, speed);
               allocations_of_outputs_ += slalom::testing::allocations() - before;
             },
             [](const Command&, Stamp) {}, [](const std::vector<Waypoint>&, bool) {}, log, log}};
  }

  void start_localiser(const std::optional<KnownPlace>& earlier) {
    LocaliserCore::Settings settings;
    settings.course = wren;
    settings.earlier = earlier;
    const auto log = [this](const std::string& line) { outputs_.log("localiser", line); };
    localiser_.emplace(
        settings, clocks_, frames(),
        LocaliserCore::Outputs{[](const Pose&, const Estimate&, Stamp) {},
                               [this](const Pose& frame, Stamp stamp) { map_to_odometry_.add(stamp, frame); },
                               [](const Grid&) {}, log, log});
    localiser_->use_course();
  }

  Clocks clocks_;
  ComputerOutputs outputs_;
  Pose laser_;
  TransformHistory map_to_odometry_, odometry_to_base_;
  std::optional<Fault> fault_;
  std::optional<KnownPlace> kept_;
  long ticks_ = 0;
  long allocations_ = 0, allocations_of_outputs_ = 0;
  PlannerCore planner_;
  std::optional<LocaliserCore> localiser_;
};

std::vector<Fault> faults_of_the_nodes() {
  std::vector<Fault> faults = read_faults(SLALOM_FAULTS);
  std::erase_if(faults, [](const Fault& fault) { return fault.name == "planner dies"; });
  return faults;
}

class NodeFault : public ::testing::TestWithParam<Fault> {};

TEST_P(NodeFault, StopsTheCarWithAReasonAndThenItDrivesOn) {
  expect_a_stop_with_a_reason<NodeComputer>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, NodeFault, ::testing::ValuesIn(faults_of_the_nodes()), name_of_test);

class NodeDrive : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(drive_.run_until(30, [&] { return drive_.drives(); })) << drive_.log();
  }

  PlannerCore& planner() { return drive_.computer().planner(); }

  Drive<NodeComputer> drive_;
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
  for (int k = 0; k < 8; ++k) {
    drive_.run(1.1 + 0.07 * k);
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

TEST(RecentValuesTest, PercentilesAreThoseOfTheSortedValues) {
  RecentValues values;
  EXPECT_EQ(values.percentile(0.5), 0);
  for (int i = 100; i >= 1; --i) values.add(i);
  EXPECT_EQ(values.percentile(0.5), 50);
  EXPECT_EQ(values.percentile(0.99), 99);
  EXPECT_EQ(values.percentile(0), 1);
  EXPECT_EQ(values.percentile(1), 100);
  for (int i = 0; i < 400; ++i) values.add(7);
  EXPECT_EQ(values.percentile(0.99), 7) << "only the latest count";
}

}  // namespace
}  // namespace slalom_bridge::testing
