#pragma once

#include <cstddef>
#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::sim {

/// A closed polyline with its arc length, to measure laps along: a centre line or a raceline.
class LapPath {
 public:
  /// The last point is joined to the first. Throws std::invalid_argument on fewer than 3 points, points that
  /// are not finite, or no length.
  explicit LapPath(std::vector<maps::Point> points);

  double length() const noexcept { return start_.back(); }      ///< m, once round
  std::size_t size() const noexcept { return points_.size(); }  ///< number of points of the path
  /// Points of the path, m, map frame.
  const std::vector<maps::Point>& points() const noexcept { return points_; }

  /// A position on the path.
  struct Place {
    std::size_t segment = 0;  ///< index of the point before the position
    double arc = 0;           ///< m from the first point, in [0, length)
    double offset = 0;        ///< m, to the left positive
    double distance = 0;      ///< m
  };

  /// The place of a car: the nearest one, or of several, where the path crosses itself, the one whose
  /// direction is the car's (see maps::place_on_path).
  Place project(const maps::Pose& pose) const noexcept;

  /// The nearest place among the segments within `reach` (m) of arc either way of segment `near`,
  /// which must be less than size().
  Place project_near(const maps::Point& point, std::size_t near, double reach) const noexcept;

  /// The pose on the path at an arc length (m, any number of turns), facing along it.
  maps::Pose at(double arc) const noexcept;

 private:
  Place place(const maps::Point& point, std::size_t segment) const noexcept;

  std::vector<maps::Point> points_;
  std::vector<double> start_;  ///< arc length at each point, then the whole length
};

/// Laps of one car by arc length along a path. Driving backwards reduces the progress; the finish line is
/// where the car started. Times are interpolated within a step.
class LapTimer {
 public:
  /// Starts at the first point of the path, at time 0.
  explicit LapTimer(const LapPath& path) { reset(path, path.at(0), 0); }

  /// Starts at a pose and time (s).
  void reset(const LapPath& path, const maps::Pose& pose, double time) noexcept;

  /// Counts a step. Call it after each one, with the position and the time (s) reached.
  void update(const LapPath& path, const maps::Point& position, double time) noexcept;

  /// The car was moved elsewhere: progress continues from there, and the distance between does not count.
  void relocate(const LapPath& path, const maps::Pose& pose) noexcept { place_ = path.project(pose); }

  int laps() const noexcept { return laps_; }             ///< whole laps driven
  double progress() const noexcept { return progress_; }  ///< m since the start, backwards counts down
  double last_lap_time() const noexcept { return last_lap_time_; }  ///< s; 0 before the first is complete
  double lap_start_time() const noexcept { return lap_start_; }     ///< s, when the present lap began
  double offset() const noexcept { return place_.offset; }          ///< m off the path, to the left positive
  double arc() const noexcept { return place_.arc; }                ///< m along the path from its first point

 private:
  LapPath::Place place_;
  double progress_ = 0;
  double time_ = 0;
  double lap_start_ = 0;
  double last_lap_time_ = 0;
  int laps_ = 0;
};

/// Laps as f1tenth_gym counts them: the zone around the car's own start lies within 0.316 m of a line
/// 4 m long, across the heading of the first car's start. Each crossing of the zone's border counts as half a
/// lap, in either direction, and after two laps the time stops.
class StartZoneLaps {
 public:
  /// `own` is the car's start, `heading` (rad) the first car's yaw there.
  void reset(const maps::Point& own, double heading) noexcept;

  /// Updates with the position of the car; `time` in s.
  void update(const maps::Point& position, double time) noexcept;

  bool near_start() const noexcept { return near_; }        ///< whether the car is in the start zone
  int toggles() const noexcept { return toggles_; }         ///< crossings of the zone's border
  int laps() const noexcept { return toggles_ / 2; }        ///< number of finished laps
  double time() const noexcept { return time_; }            ///< s
  bool finished() const noexcept { return toggles_ >= 4; }  ///< whether two laps are finished

 private:
  maps::Point start_;
  double cosine_ = 1;
  double sine_ = 0;
  bool near_ = true;
  int toggles_ = 0;
  double time_ = 0;
};

}  // namespace slalom::sim
