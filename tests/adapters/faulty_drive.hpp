#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "node_computer.hpp"

namespace slalom::nodes::testing {

// The names of the tests.
inline void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}
inline std::string name_of_test(const ::testing::TestParamInfo<Fault>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// A simulated car and its computer, with simulated clocks.
class Drive {
 public:
  Drive()
      : car_(SLALOM_COURSES "/wren", 1, 3),
        computer_({[this] { return time_ + ahead_; }, [this] { return time_; }},
                  {[this](const Command& command) {
                     commands_.push_back({time_, command});
                   },
                   [this](const std::string& node, const std::string& line) {
                     said_.push_back({time_, node, line});
                   }}) {}

  void begin(const Fault& fault) {
    car_.begin(fault);
    computer_.begin(fault);
    if (fault.of == "map") hear_map();
    if (fault.of == "clock") ahead_ += fault.value;
  }
  void end() {
    const bool was_of_map = car_.has("map", "resolution");
    car_.end();
    computer_.end();
    if (was_of_map) hear_map();
  }
  void hear_map() { computer_.hear_map(car_.map()); }

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

  NodeComputer& computer() { return computer_; }
  double time() const { return time_; }                           // s
  double speed() const { return car_.car().odometry().speed(); }  // m/s
  bool car_stands() const { return car_.stands(); }
  /// Whether the commands of the last 0.3 s drive, or stop.
  bool drives() const {
    return all_of_last(0.3, [](double speed) { return speed > 0.2; });
  }
  bool stops() const {
    return all_of_last(0.3, [](double speed) { return speed == 0; });
  }
  /// Whether commands to stop have lasted for 0.2 s since a time.
  bool has_stopped_since(double since) const {
    const auto stopped = [&](const Sent& c) { return c.time >= since && c.command.speed == 0; };
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

  /// The number of lines with these words that were logged since a time.
  long count_said(const std::string& words, double since) const {
    return std::count_if(said_.begin(), said_.end(), [&](const Line& line) {
      return line.time >= since && line.text.find(words) != std::string::npos;
    });
  }

  void expect_valid_commands() const {
    for (const auto& [time, command] : commands_) {
      ASSERT_TRUE(std::isfinite(command.steer) && std::isfinite(command.speed)) << "at " << time << " s";
      ASSERT_LE(std::abs(command.steer), 0.4189 + 1e-9) << "at " << time << " s";
      ASSERT_LE(std::abs(command.speed), 12) << "at " << time << " s";
    }
  }
  void expect_a_reason_per_second() const {
    std::map<std::string, double> last;
    for (const Line& line : said_) {
      if (!is_reason(line.text)) continue;
      const auto before = last.find(line.node);
      if (before != last.end()) {
        EXPECT_GE(line.time - before->second, 0.99) << line.text;
      }
      last[line.node] = line.time;
    }
  }
  std::string log() const {
    std::string text;
    for (const Line& line : said_)
      text += std::to_string(line.time) + " s: " + line.node + ": " + line.text + "\n";
    return text;
  }

 private:
  struct Sent {
    double time;  // s
    Command command;
  };
  struct Line {
    double time;  // s
    std::string node, text;
  };

  static bool is_reason(const std::string& text) {
    return text.rfind("stopping:", 0) == 0 || text.rfind("braking:", 0) == 0 ||
           text.rfind("localisation:", 0) == 0;
  }

  template <class Holds>
  bool all_of_last(double seconds, Holds&& holds) const {
    int count = 0;
    for (auto c = commands_.rbegin(); c != commands_.rend() && c->time >= time_ - seconds; ++c, ++count)
      if (!holds(c->command.speed)) return false;
    return count > 3;
  }

  void step() {
    constexpr int ticks = 5;
    for (int i = 0; i < ticks; ++i) {
      time_ += period / ticks;
      computer_.tick();
    }
    if (car_.has("planner", "twice")) computer_.hear_other_command();
    const bool commanded = !commands_.empty() && time_ - commands_.back().time < 0.2;
    car_.step(commanded ? commands_.back().command : Command{}, time_ + ahead_);
    for (const auto& m : car_.odometry) computer_.hear(m);
    for (const auto& m : car_.scans) computer_.hear(m);
  }

  double time_ = 1000, ahead_ = 0;  // s
  std::vector<Sent> commands_;
  std::vector<Line> said_;
  FaultyCar car_;
  NodeComputer computer_;
};

/// Expects that a fault stops the car with a reason, and that it then drives on.
inline void expect_a_stop_with_a_reason(const Fault& fault) {
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

}  // namespace slalom::nodes::testing
