#pragma once

#include "tracking/readings.hpp"

namespace slalom::tracking {

constexpr double right_angle = 0.5 * std::numbers::pi;  ///< rad

/// The rectangle that fits the readings of an object best.
struct BoxFit {
  double angle = 0;            ///< rad, of its first side, in [0, pi / 2)
  double extent[2] = {};       ///< m, of the readings along the first side and across it
  double angle_deviation = 0;  ///< rad
};

/// Searches the angle at which the readings lie closest to two perpendicular sides: Zhang et al. (2017),
/// algorithm 2 with the criterion of algorithm 4. At least two readings; `deviation` is that of a range (m).
BoxFit fit_box(std::span<const Reading> readings, double deviation) noexcept;

/// The prior of a box: its axes, the expected size, and how far the readings support its ends.
struct BoxPrior {
  maps::Pose pose;            ///< predicted pose of the middle
  double size[2] = {};        ///< m, length and width
  double size_deviation = 0;  ///< m, of both
};

/// A coordinate of the middle of a box in the axes of its prior.
struct AxisMeasurement {
  double offset = 0;    ///< m, from the predicted middle
  double variance = 0;  ///< m^2
  double size = 0;      ///< m, where both ends are in view; else 0
};

/// Measures the middle of a box along its two axes from readings in the order of their beams. A side that
/// faces the sensor gives the middle by half the size behind it; ends of a side give it by half the size
/// between them; an end that something else hides gives nothing.
void measure_box(const BoxPrior& prior, const Readings& scan, std::span<const Reading> readings,
                 double min_incidence, double deviation, AxisMeasurement (&axes)[2]) noexcept;

}  // namespace slalom::tracking
