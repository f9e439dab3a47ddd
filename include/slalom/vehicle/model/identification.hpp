#pragma once

#include <span>

/// Identification of a car's steering from a recorded drive: gain, offset, delay and lag, and the wheelbase.
///
/// The model is the kinematic bicycle of the vehicle problem with a steering servo and understeer,
///
///     steer' = (gain u(t - delay) + offset - steer) / time_constant
///     yaw'   = v tan(steer) / (wheelbase + understeer v^2)
///
/// (R. Rajamani, "Vehicle Dynamics and Control", 2nd ed., eq. 2.2 and 3.13), fitted to the
/// change of yaw from one sample to the next by least squares (Levenberg 1944, Marquardt 1963). Gain and
/// wheelbase differ in their effect only by the curvature of the tangent, so give the wheelbase if it is
/// known from a measurement.
namespace slalom::vehicle {

/// One control step of the drive.
struct DrivenSample {
  double time = 0;      ///< s
  double x = 0, y = 0;  ///< m, of the rear axle, map frame
  double yaw = 0;       ///< rad; must not be computed from the steering angle, as in plain wheel odometry
  double speed = 0;     ///< m/s, as measured
  double steer_command = 0;  ///< rad, sent now
};

/// What is known in advance.
struct IdentificationOptions {
  double wheelbase = 0;      ///< m; 0: identified as well
  double least_speed = 0.5;  ///< m/s, slower samples are not used
};

/// A value and its standard deviation.
struct Identified {
  double value = 0;      ///< in the unit of the quantity
  double deviation = 0;  ///< standard deviation, in the same unit; 0 where the value was given
};

/// The result.
struct Identification {
  Identified steering_gain;    ///< wheels' angle / commanded angle
  Identified steering_offset;  ///< rad
  Identified delay;            ///< s, from the sample's time to the first effect of its command
  Identified time_constant;    ///< s
  Identified wheelbase;        ///< m
  Identified understeer;       ///< s^2/m
  double speed_scale = 1;      ///< distance by the poses / distance by the measured speed
  double residual = 0;         ///< rad/s, root mean square of the unexplained yaw rate
  double explained = 0;        ///< explained share of the variance of the yaw rate, 0 .. 1
  int samples = 0;             ///< number of samples used
};

/// Fits the model. A gap of more than 0.2 s between samples, or a decreasing time, begins a new segment.
/// Throws std::invalid_argument where there are fewer than 200 usable samples or the steering hardly moves;
/// the message says what is missing. Throws it also on a negative wheelbase or a `least_speed` not above 0.
Identification identify(std::span<const DrivenSample> samples, const IdentificationOptions& options = {});

}  // namespace slalom::vehicle
