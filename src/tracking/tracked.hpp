#pragma once

#include <algorithm>

#include "slalom/tracking/object_tracker.hpp"
#include "tracking/box_fit.hpp"
#include "tracking/readings.hpp"

namespace slalom::tracking {

/// A normal distribution with the steps of a Kalman filter.
template <int Size>
struct Gaussian {
  double mean[Size] = {};
  double covariance[Size][Size] = {};

  /// covariance = F covariance F^T
  void propagate(const double (&transition)[Size][Size]) noexcept {
    double left[Size][Size] = {};
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j)
        for (int k = 0; k < Size; ++k) left[i][j] += transition[i][k] * covariance[k][j];
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) {
        double sum = 0;
        for (int k = 0; k < Size; ++k) sum += left[i][k] * transition[j][k];
        covariance[i][j] = sum;
      }
  }

  /// Adds noise of the given variance along a direction: covariance += variance g g^T.
  void add_noise(const double (&direction)[Size], double variance) noexcept {
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) covariance[i][j] += variance * direction[i] * direction[j];
  }

  /// Variance of h^T x.
  double variance_along(const double (&row)[Size]) const noexcept {
    double sum = 0;
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) sum += row[i] * covariance[i][j] * row[j];
    return sum;
  }

  /// Corrects with a scalar measurement of h^T x: `innovation` is measured minus predicted.
  void correct(const double (&row)[Size], double innovation, double variance) noexcept {
    double gain[Size] = {};
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) gain[i] += covariance[i][j] * row[j];
    double total = variance;
    for (int i = 0; i < Size; ++i) total += row[i] * gain[i];
    for (int i = 0; i < Size; ++i) mean[i] += gain[i] * innovation / total;
    // P - (P h)(P h)^T / s is symmetric whatever the rounding.
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j < Size; ++j) covariance[i][j] -= gain[i] * gain[j] / total;
    for (int i = 0; i < Size; ++i) covariance[i][i] = std::max(covariance[i][i], 1e-9);
  }
};

/// An object with its filters.
class Tracked {
 public:
  Tracked() = default;
  /// A new object at a cluster.
  Tracked(int id, const TrackerOptions& options, const Readings& scan,
          std::span<const Reading> readings) noexcept;

  void predict(double elapsed, const TrackerOptions& options) noexcept;  ///< predicts by `elapsed` seconds
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
