// The ROS 2 driver with every fault of adapters/test/faults.csv that it can have: with the real localiser and
// planner, a simulated car and simulated clocks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "dds/nodes/driver.hpp"
#include "test/faulty_car.hpp"

namespace slalom_bridge::testing {

/// For the names of the tests.
static void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

}  // namespace slalom_bridge::testing

namespace slalom_ros2 {
namespace {

using slalom_bridge::testing::Fault;
using slalom_bridge::testing::FaultyCar;

constexpr double period = 0.025;  // s, of the car

/// A car and its driver.
class Drive {
 public:
  explicit Drive(bool map_from_topic = false)
      : car_(SLALOM_COURSES "/wren", 1, 0),
        driver_({.course = SLALOM_COURSES "/wren",
                 .configuration = SLALOM_CONFIGS "/default.yaml",
                 .map_from_topic = map_from_topic,
                 .set = {{"svg_mppi/samples", "500"}}},
                {[this] { return time_ + ahead_; }, [this] { return time_; }},
                {[this](double steer, double speed) {
                   commands_.push_back({time_, steer, speed});
                 },
                 [](const Pose&) {},
                 [this](const std::string& line) {
                   said_.push_back({time_, line});
                 }}) {}

  void begin(const Fault& fault) {
    fault_ = fault;
    car_.begin(fault);
    if (fault.of == "map") hear_map();
    if (fault.of == "clock") ahead_ += fault.value;
  }
  void end() {
    const bool was_of_map = fault_ && fault_->of == "map";
    fault_.reset();
    car_.end();
    if (was_of_map) hear_map();
  }
  void hear_map() { driver_.hear_map(car_.map()); }

  /// Drives until something holds, for at most `most` (s). Returns whether it holds.
  template <class Holds>
  bool run_until(double most, Holds&& holds) {
    for (const double begin = time_; time_ < begin + most;) {
      step();
      if (holds()) return true;
    }
    return false;
  }
  void run(double seconds) {
    run_until(seconds, [] { return false; });
  }

  double time() const { return time_; }  // s
  bool car_stands() const { return std::abs(car_.reading().speed) < 0.2; }
  /// Whether the commands of the last 0.3 s drive, or stop.
  bool drives() const {
    return all_of_last(0.3, [](double speed) { return speed > 0.2; });
  }
  bool stops() const {
    return all_of_last(0.3, [](double speed) { return speed == 0; });
  }
  /// Whether commands to stop have lasted for 0.2 s since a time.
  bool has_stopped_since(double since) const {
    const auto stopped = [&](const Command& c) { return c.time >= since && c.speed == 0; };
    const auto first = std::find_if(commands_.begin(), commands_.end(), stopped);
    const auto last = std::find_if(commands_.rbegin(), commands_.rend(), stopped);
    return first != commands_.end() && last->time - first->time > 0.2;
  }
  /// Whether a reason with these words has been logged since a time.
  bool has_said(const std::string& words, double since) const {
    return std::any_of(said_.begin(), said_.end(), [&](const Line& line) {
      return line.time >= since && is_reason(line.text) && line.text.find(words) != std::string::npos;
    });
  }

  void expect_valid_commands() const {
    for (const Command& c : commands_) {
      ASSERT_TRUE(std::isfinite(c.steer) && std::isfinite(c.speed)) << "at " << c.time << " s";
      ASSERT_LE(std::abs(c.steer), 0.4189 + 1e-9) << "at " << c.time << " s";
      ASSERT_LE(std::abs(c.speed), 12) << "at " << c.time << " s";
    }
  }
  void expect_a_reason_per_second() const {
    double last = -1;
    for (const Line& line : said_) {
      if (!is_reason(line.text)) continue;
      EXPECT_GE(line.time - last, 0.99) << line.text;
      last = line.time;
    }
  }
  std::string log() const {
    std::string text;
    for (const Line& line : said_) text += std::to_string(line.time) + " s: " + line.text + "\n";
    return text;
  }

 private:
  struct Command {
    double time, steer, speed;  // s, rad, m/s
  };
  struct Line {
    double time;  // s
    std::string text;
  };

  static bool is_reason(const std::string& text) {
    return text.rfind("stopping:", 0) == 0 || text.rfind("braking:", 0) == 0;
  }

  template <class Holds>
  bool all_of_last(double seconds, Holds&& holds) const {
    int count = 0;
    for (auto c = commands_.rbegin(); c != commands_.rend() && c->time >= time_ - seconds; ++c, ++count)
      if (!holds(c->speed)) return false;
    return count > 3;
  }

  void step() {
    constexpr int ticks = 5;
    for (int i = 0; i < ticks; ++i) {
      time_ += period / ticks;
      driver_.tick();
    }
    if (fault_ && fault_->change == "twice") driver_.hear_other_command();
    const bool commanded = !commands_.empty() && time_ - commands_.back().time < 0.2;
    car_.step(commanded ? commands_.back().steer : 0, commanded ? commands_.back().speed : 0, time_ + ahead_);
    for (const auto& m : car_.odometry) driver_.hear_odometry(m.stamp, m.pose, m.speed);
    for (const auto& m : car_.scans)
      driver_.hear_scan(
          m.stamp,
          {m.ranges.data(), m.ranges.size(), m.angle_min, m.angle_increment, m.range_min, m.range_max},
          m.angle_max);
  }

  double time_ = 1000, ahead_ = 0;  // s
  std::vector<Command> commands_;
  std::vector<Line> said_;
  std::optional<Fault> fault_;
  FaultyCar car_;
  Driver driver_;
};

/// Those that a node can have that needs no tf and is one process.
std::vector<Fault> faults_of_the_driver() {
  std::vector<Fault> faults = slalom_bridge::testing::read_faults(SLALOM_FAULTS);
  std::erase_if(faults, [](const Fault& fault) {
    return fault.of == "tf" || fault.of == "localiser" || fault.name == "planner dies";
  });
  return faults;
}

std::string name_of_test(const ::testing::TestParamInfo<Fault>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

class DriverFault : public ::testing::TestWithParam<Fault> {};

TEST_P(DriverFault, StopsTheCarWithAReasonAndThenItDrivesOn) {
  const Fault& fault = GetParam();
  Drive drive;
  ASSERT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  drive.run(1.5);  // longer than a fault is remembered as the cause of others
  ASSERT_TRUE(drive.drives()) << drive.log();
  const double begin = drive.time();
  drive.begin(fault);
  if (fault.of == "clock") {  // it jumps once; the car continues by itself
    EXPECT_TRUE(drive.run_until(1, [&] { return drive.has_stopped_since(begin); })) << drive.log();
  } else {
    const double soon = fault.of == "map" ? 5 : 1;  // s; the localiser must see that the map does not fit
    EXPECT_TRUE(drive.run_until(soon, [&] { return drive.stops(); })) << drive.log();
    EXPECT_TRUE(drive.run_until(5, [&] { return drive.car_stands(); })) << drive.log();
    drive.run(1.5);
    EXPECT_TRUE(drive.stops()) << "must stay stopped\n" << drive.log();
  }
  EXPECT_TRUE(drive.run_until(2, [&] { return drive.has_said(fault.reason, begin); })) << drive.log();
  drive.end();
  EXPECT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  drive.expect_valid_commands();
  drive.expect_a_reason_per_second();
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, DriverFault, ::testing::ValuesIn(faults_of_the_driver()), name_of_test);

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
