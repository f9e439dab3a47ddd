#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <vector>

#include "slalom/evaluation/statistics.hpp"
#include "slalom/maps/pose.hpp"

/// Counts and times while a robot drives.
namespace slalom::evaluation {

inline constexpr double min_driving_speed = 0.03;  ///< m/s that counts as driving

/// Counts how often plans change the side on which they pass something, until the robot is past it.
class SideCounter {
 public:
  SideCounter(const maps::Pose& start, const maps::Pose& goal)
      : ahead_x_(goal.x - start.x), ahead_y_(goal.y - start.y) {}

  void add(const maps::Pose& robot, const maps::Point& counted, std::span<const maps::Pose> plan) {
    const double dx = counted.x - robot.x, dy = counted.y - robot.y;
    if (plan.empty() || dx * ahead_x_ + dy * ahead_y_ <= 0) return;
    const maps::Pose& end = plan.back();
    const double left =
        (dx * (end.y - robot.y) - dy * (end.x - robot.x)) / std::max(std::hypot(dx, dy), 1e-9);
    if (std::abs(left) < side_margin) return;
    const int side = left > 0 ? 1 : -1;
    changes_ += last_ != 0 && side != last_;
    last_ = side;
  }
  int changes() const { return changes_; }

 private:
  static constexpr double side_margin =
      0.1;  ///< m from the line to the obstacle; below it neither side is counted
  double ahead_x_, ahead_y_;
  int last_ = 0, changes_ = 0;
};

/// Counts changes between driving forward and back.
class ReversalCounter {
 public:
  void add(double forward) {
    const int now = forward > min_driving_speed ? 1 : forward < -min_driving_speed ? -1 : 0;
    changes_ += now == -direction_;
    if (now != 0) direction_ = now;
  }
  int changes() const { return changes_; }

 private:
  int direction_ = 1, changes_ = 0;
};

/// Wall-clock times of updates.
class Stopwatch {
 public:
  template <class Work>
  auto measure(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    times_.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return result;
  }
  /// s; 0 without times. evaluation::percentile has the rule.
  double percentile(double share) const { return times_.empty() ? 0 : evaluation::percentile(times_, share); }

 private:
  std::vector<double> times_;
};

}  // namespace slalom::evaluation
