#pragma once

#include <algorithm>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"

namespace slalom::tracking {

/// A course as arc length and offset: points at equal distances along it, for fast look-ups.
class CourseLine {
 public:
  CourseLine() = default;  ///< no course
  /// Through at least 3 points. It is closed if its ends are not much farther apart than its points.
  explicit CourseLine(std::span<const maps::ReferencePoint> points);

  bool empty() const noexcept { return points_.empty(); }
  double length() const noexcept { return length_; }  ///< m
  bool closed() const noexcept { return closed_; }

  /// A point of the course.
  struct Point {
    double x = 0, y = 0;   ///< m
    double yaw = 0;        ///< rad
    double curvature = 0;  ///< 1/m, positive to the left
    double speed = 0;      ///< m/s
  };
  /// The point at an arc length, m; beyond the ends of an open course, the end.
  Point at(double arc) const noexcept;

  /// A position beside the course.
  struct Place {
    double arc = 0;     ///< m
    double offset = 0;  ///< m, to the left
  };
  /// The place of a car (see maps::place_on_path). Arc lengths of a closed course are within its length.
  Place project(const maps::Pose& car) const noexcept;

  /// The way from one arc length to another, m; the shorter one of a closed course.
  double between(double from, double to) const noexcept;

 private:
  std::vector<Point> points_;
  double step_ = 0;  ///< m
  double length_ = 0;
  bool closed_ = false;
};

/// Remembers how cars drove on a closed course the last time: their offset and speed over arc length. Others
/// that come round again are likely to do the same (as in Predictive Spliner, Baumann et al., 2024).
class Habits {
 public:
  struct Habit {
    double offset = 0;  ///< m
    double ratio = 0;   ///< ratio of the speed to the course's; 0: nothing is known here
  };

  explicit Habits(const CourseLine& course)
      : cells_(course.closed() ? saturate_cast<std::size_t>(course.length() / 0.5) + 1 : 0),
        spacing_(course.length() / std::max(static_cast<double>(cells_.size()), 1.0)) {}

  void reset() noexcept { std::fill(cells_.begin(), cells_.end(), Habit{}); }

  /// Remembers a car.
  void note(double arc, const Habit& habit) noexcept {
    if (!cells_.empty()) cells_[cell(arc)] = habit;
  }

  /// Returns the habit at an arc length, between those of the neighbouring cells.
  Habit at(double arc) const noexcept {
    if (cells_.empty()) return {};
    const double place = arc / spacing_ - 0.5;
    const double share = place - std::floor(place);
    const Habit &here = cells_[cell(arc - 0.5 * spacing_)], &next = cells_[cell(arc + 0.5 * spacing_)];
    if (here.ratio <= 0 || next.ratio <= 0) return {};
    return {here.offset + share * (next.offset - here.offset),
            here.ratio + share * (next.ratio - here.ratio)};
  }

 private:
  std::size_t cell(double arc) const noexcept {
    const double length = spacing_ * cells_.size();
    const double wrapped = arc - length * std::floor(arc / length);
    return std::min(saturate_cast<std::size_t>(wrapped / spacing_), cells_.size() - 1);
  }

  std::vector<Habit> cells_;  ///< habits along the course, every 0.5 m or less
  double spacing_;            ///< m, length of a cell
};

}  // namespace slalom::tracking
