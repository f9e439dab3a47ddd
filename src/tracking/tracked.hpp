#pragma once

#include <span>

#include "slalom/tracking/object_tracker.hpp"
#include "tracking/box_fit.hpp"
#include "tracking/gaussian.hpp"
#include "tracking/readings.hpp"

namespace slalom::tracking {

/// An object with its filters.
class Tracked {
 public:
  Tracked() = default;
  /// A new object at a cluster.
  Tracked(int id, const TrackerOptions& options, const Readings& scan,
          std::span<const Reading> readings) noexcept;

  /// Predicts by `elapsed` seconds.
  void predict(double elapsed, const TrackerOptions& options) noexcept;
  /// Corrects with the readings of the object, in the order of their beams; at least two. `moves`: they show
  /// that it moves, or this need not be known.
  void correct(const TrackerOptions& options, const Readings& scan, std::span<const Reading> readings,
               bool moves) noexcept;
  /// No reading was found; `seen_through` if beams went through where it should be.
  void miss(bool seen_through) noexcept;

  int id() const noexcept { return id_; }
  bool confirmed() const noexcept { return confirmed_; }
  bool finite() const noexcept;
  /// Confirms it if it may be: enough scans, and with `min_speed` above 0 a motion beyond doubt.
  void confirm(const TrackerOptions& options, double min_speed) noexcept;
  int misses() const noexcept { return misses_; }  ///< scans in a row that saw through its place
  /// Scans in a row with readings that do not show that it moves.
  int at_rest() const noexcept { return at_rest_; }
  double unseen() const noexcept { return unseen_; }   ///< s
  maps::Pose pose() const noexcept;                    ///< pose of the middle
  double length() const noexcept { return size_[0]; }  ///< m
  double width() const noexcept { return size_[1]; }   ///< m
  double position_variance() const noexcept;           ///< m^2, mean over x and y
  TrackedObject object() const noexcept;

 private:
  void correct_new(const TrackerOptions& options, const Readings& scan,
                   std::span<const Reading> readings) noexcept;
  void take_over() noexcept;
  Gaussian<5> turning() const noexcept;
  void correct_size(const AxisMeasurement (&axes)[2], double deviation) noexcept;

  int id_ = 0;
  bool round_ = false;  ///< whether its outline gives no yaw
  bool confirmed_ = false;
  bool turns_ = false;   ///< `state_` has taken over from `point_`
  Gaussian<5> state_;    ///< x, y, yaw, speed, yaw rate; once its motion is known
  Gaussian<4> point_;    ///< x, y and their velocities; until then
  double yaw_ = 0;       ///< rad, of the box until then
  double size_[2] = {};  ///< m
  double size_variance_[2] = {};
  int scans_ = 0, misses_ = 0, at_rest_ = 0;
  double unseen_ = 0;
};

}  // namespace slalom::tracking
