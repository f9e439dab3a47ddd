#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "slalom/evaluation/statistics.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::evaluation {

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
  static constexpr double side_margin = 0.1;  ///< m from the line; below it neither side is counted
  double ahead_x_, ahead_y_;
  int last_ = 0, changes_ = 0;
};

/// Counts the changes of sign of values that are large enough.
class SignCounter {
 public:
  SignCounter(double least, int sign) : least_(least), sign_(sign) {}
  void add(double value) {
    const int now = value > least_ ? 1 : value < -least_ ? -1 : 0;
    changes_ += now != 0 && now == -sign_;
    if (now != 0) sign_ = now;
  }
  int changes() const { return changes_; }

 private:
  double least_;
  int sign_, changes_ = 0;
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

/// The length of a path (m).
inline double length_of(std::span<const maps::Pose> path) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    length += std::hypot(path[i + 1].x - path[i].x, path[i + 1].y - path[i].y);
  return length;
}

/// The distance of a point from a path (m).
inline double distance_from(std::span<const maps::Pose> path, const maps::Pose& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double dx = path[i + 1].x - path[i].x, dy = path[i + 1].y - path[i].y,
                 squared = std::max(dx * dx + dy * dy, 1e-12);
    const double share =
        std::clamp(((point.x - path[i].x) * dx + (point.y - path[i].y) * dy) / squared, 0.0, 1.0);
    least = std::min(least, std::hypot(path[i].x + share * dx - point.x, path[i].y + share * dy - point.y));
  }
  return least;
}

}  // namespace slalom::evaluation
