#pragma once

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "logic/installed.hpp"
#include "logic/localiser_core.hpp"
#include "logic/simulated_car.hpp"

/// A simulated car whose messages can have the faults of faults.csv.
namespace slalom::nodes::testing {

/// A row of faults.csv.
struct Fault {
  std::string name;
  std::string of;      ///< the part that has it
  std::string change;  ///< the change of the part
  double value = 0;
  std::string reason;  ///< words in the logged reason
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

/// A scan with its own ranges.
struct ScanMessage {
  Stamp stamp = 0;
  std::vector<float> ranges;        ///< m
  maps::LaserScanView description;  ///< angles and range limits
  double angle_max = 0;             ///< rad

  maps::LaserScanView view() const {
    maps::LaserScanView scan = description;
    scan.ranges = ranges;
    return scan;
  }
};

class FaultyCar {
 public:
  /// Throws std::exception.
  FaultyCar(const std::string& course, std::uint64_t seed, int obstacles)
      : course_(load_course(course)), car_(course_, seed, obstacles) {}

  /// Gives all messages from the next one on the fault.
  void begin(const Fault& fault) {
    fault_ = fault;
    held_.reset();
  }
  void end() { fault_.reset(); }
  bool has(const char* of, const char* change) const {
    return fault_ && fault_->of == of && fault_->change == change;
  }
  /// The fault, if there is one.
  const std::optional<Fault>& fault() const { return fault_; }

  /// Drives 25 ms. Then `odometry` and `scans` have the messages of the car with this stamp (s).
  void step(const Command& command, double stamp) {
    car_.step(command);
    odometry.clear();
    scans.clear();
    if (has("world", "dies")) return;
    if (!has("odometry", "silent")) publish_odometry(stamp);
    if (!has("scan", "silent")) publish_scan(stamp);
  }
  /// The map, as it is published.
  maps::OccupancyGrid map() const {
    maps::OccupancyGrid map = course_.map;
    if (has("map", "resolution")) map.resolution *= fault_->value;
    return map;
  }
  /// Whether the car is slower than 0.2 m/s.
  bool stands() const { return std::abs(car_.odometry().speed()) < 0.2; }
  const SimulatedCar& car() const { return car_; }

  std::vector<OdometrySample> odometry;  ///< odometry of the last step, in the order of its arrival
  std::vector<ScanMessage> scans;        ///< scans of the last step, in the order of their arrival

 private:
  void publish_odometry(double stamp) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    constexpr double jump_interval = 0.2;  // s
    const sim::WheelOdometry& seen = car_.odometry();
    OdometrySample m{stamp_of(stamp), seen.pose(), seen.speed(), seen.yaw_rate()};
    if (has("odometry", "not a number")) m.pose.x = m.speed = unknown;
    if (has("odometry", "stamp")) m.stamp += stamp_of(fault_->value);
    if (has("odometry", "jumps")) m.pose.x += fault_->value * std::fmod(std::floor(stamp / jump_interval), 2);
    if (has("odometry", "shift")) m.pose.x += fault_->value;
    if (has("odometry", "speed")) m.speed = fault_->value;
    odometry.push_back(m);
  }

  void publish_scan(double stamp) {
    const maps::LaserScanView seen = car_.scan();
    ScanMessage m{stamp_of(stamp), {seen.ranges.begin(), seen.ranges.end()}, seen, 0};
    m.angle_max = seen.angle_min + seen.angle_increment * (static_cast<double>(seen.ranges.size()) - 1);
    m.description.range_min = 0.02;
    if (has("scan", "not a number"))
      m.ranges.assign(m.ranges.size(), std::numeric_limits<float>::quiet_NaN());
    if (has("scan", "half of the beams")) m.ranges.resize(m.ranges.size() / 2);
    if (has("scan", "stamp")) m.stamp += stamp_of(fault_->value);
    if (!has("scan", "swapped")) return scans.push_back(std::move(m));
    if (!held_) {
      held_ = std::move(m);
      return;
    }
    scans.push_back(std::move(m));
    scans.push_back(*std::exchange(held_, std::nullopt));
  }

  vehicle::Course course_;
  SimulatedCar car_;
  std::optional<Fault> fault_;
  std::optional<ScanMessage> held_;  ///< the scan that the next one overtakes
};

}  // namespace slalom::nodes::testing
