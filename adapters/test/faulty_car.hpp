#pragma once

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bridge/bridge.hpp"

/// A simulated car whose messages can have the faults of faults.csv.
namespace slalom_bridge::testing {

/// A row of faults.csv.
struct Fault {
  std::string name;
  std::string of;      ///< what has it
  std::string change;  ///< how it is changed
  double value = 0;
  std::string reason;  ///< words of the reason that is logged
};

/// Reads a row. Throws std::invalid_argument if it does not have five values.
inline Fault parse_fault(const std::string& row) {
  std::vector<std::string> values(1);
  for (const char c : row) {
    if (c == ',')
      values.emplace_back();
    else
      values.back() += c;
  }
  if (values.size() != 5) throw std::invalid_argument("'" + row + "' must have five values");
  return {values[0], values[1], values[2], values[3].empty() ? 0 : std::stod(values[3]), values[4]};
}

/// The rows of the file. Throws std::runtime_error if there are none.
inline std::vector<Fault> read_faults(const std::string& file) {
  std::ifstream stream(file);
  std::vector<Fault> faults;
  bool in_header = true;
  for (std::string row; std::getline(stream, row);) {
    if (row.empty() || row[0] == '#') continue;
    if (!std::exchange(in_header, false)) faults.push_back(parse_fault(row));
  }
  if (faults.empty()) throw std::runtime_error(file + ": no faults");
  return faults;
}

struct OdometryMessage {
  double stamp = 0;                ///< s
  Pose pose;                       ///< of the rear axle, odometry frame
  double speed = 0, yaw_rate = 0;  ///< m/s, rad/s
};

struct ScanMessage {
  double stamp = 0;                                          ///< s
  std::vector<float> ranges;                                 ///< m
  double angle_min = 0, angle_max = 0, angle_increment = 0;  ///< rad
  double range_min = 0, range_max = 0;                       ///< m
};

class FaultyCar {
 public:
  /// Throws std::exception.
  FaultyCar(const std::string& course, std::uint64_t seed, int obstacles)
      : world_(course, seed, obstacles), map_(load_course(course).map) {}

  /// From the next message on, messages have the fault.
  void begin(const Fault& fault) {
    fault_ = fault;
    held_.reset();
  }
  void end() { fault_.reset(); }
  const std::optional<Fault>& fault() const { return fault_; }

  /// Drives 25 ms. Then `odometry` and `scans` have what the car publishes with this stamp (s).
  void step(double steer, double speed, double stamp) {
    world_.step(steer, speed);
    odometry.clear();
    scans.clear();
    if (has("world", "dies")) return;
    if (!has("odometry", "silent")) publish_odometry(stamp);
    if (!has("scan", "silent")) publish_scan(stamp);
  }
  /// The map, as it is published.
  Grid map() const {
    Grid map = map_;
    if (has("map", "resolution")) map.resolution *= fault_->value;
    return map;
  }

  const World::Reading& reading() const { return world_.reading(); }

  std::vector<OdometryMessage> odometry;  ///< of the last step, in the order of their arrival
  std::vector<ScanMessage> scans;         ///< likewise

 private:
  bool has(const char* of, const char* change) const {
    return fault_ && fault_->of == of && fault_->change == change;
  }

  void publish_odometry(double stamp) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    constexpr double jump_interval = 0.2;  // s
    const World::Reading& seen = world_.reading();
    OdometryMessage m{stamp, seen.odometry, seen.speed, seen.yaw_rate};
    if (has("odometry", "not a number")) m.pose.x = m.speed = unknown;
    if (has("odometry", "stamp")) m.stamp += fault_->value;
    if (has("odometry", "jumps")) m.pose.x += fault_->value * std::fmod(std::floor(stamp / jump_interval), 2);
    if (has("odometry", "shift")) m.pose.x += fault_->value;
    if (has("odometry", "speed")) m.speed = fault_->value;
    odometry.push_back(m);
  }

  void publish_scan(double stamp) {
    const World::Reading& seen = world_.reading();
    ScanMessage m;
    m.stamp = stamp;
    m.ranges = seen.ranges;
    m.angle_min = seen.angle_min;
    m.angle_increment = seen.angle_increment;
    m.angle_max = seen.angle_min + seen.angle_increment * (static_cast<double>(seen.ranges.size()) - 1);
    m.range_min = 0.02;
    m.range_max = seen.range_max;
    if (has("scan", "not a number"))
      m.ranges.assign(m.ranges.size(), std::numeric_limits<float>::quiet_NaN());
    if (has("scan", "half of the beams")) m.ranges.resize(m.ranges.size() / 2);
    if (has("scan", "stamp")) m.stamp += fault_->value;
    if (!has("scan", "swapped")) return scans.push_back(std::move(m));
    if (!held_) {
      held_ = std::move(m);
      return;
    }
    scans.push_back(std::move(m));
    scans.push_back(*std::exchange(held_, std::nullopt));
  }

  World world_;
  Grid map_;
  std::optional<Fault> fault_;
  std::optional<ScanMessage> held_;  ///< which the next one overtakes
};

}  // namespace slalom_bridge::testing
