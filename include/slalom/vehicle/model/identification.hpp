#pragma once

#include <span>

/// Identification of a car from a drive: wheelbase, understeer, and gain, offset, delay and lag of steering.
///
/// The model is the kinematic bicycle of the vehicle problem with a steering servo and understeer,
///
///     steer' = (gain u(t - delay) + offset - steer) / time_constant
///     yaw'   = v tan(steer) / (wheelbase + understeer v^2)
///
/// (R. Rajamani, "Vehicle Dynamics and Control", 2nd ed., eq. 2.2 and 3.13), fitted to the change of yaw
/// from one sample to the next by least squares (Levenberg 1944, Marquardt 1963). Gain and wheelbase differ
/// in effect only through the nonlinearity of the tangent, so give a wheelbase that was measured.
namespace slalom::vehicle {

/// One control step of the drive.
struct DrivenSample {
  double time = 0;      ///< s
  double x = 0, y = 0;  ///< m, of the rear axle, map frame
  double yaw = 0;       ///< rad; must not be computed from the steering angle, as in plain wheel odometry
  double speed = 0;     ///< m/s, as measured, along the car's axis
  double steer_command = 0;  ///< rad, sent at `time`
  double speed_command = 0;  ///< m/s, sent at `time`; not used to identify
};

/// The values that are known in advance.
struct IdentificationOptions {
  double wheelbase = 0;    ///< m; 0: estimated as well
  double min_speed = 0.5;  ///< m/s, > 0; slower samples are not used
};

/// An estimate and its standard deviation.
struct Identified {
  double value = 0;  ///< value in the unit of the quantity
  /// Standard deviation, in the same unit; 0 of a given value, infinite if the drive does not determine it.
  double deviation = 0;
};

/// The result.
struct Identification {
  Identified steering_gain;    ///< angle of the wheels / commanded angle
  Identified steering_offset;  ///< rad, angle of the wheels at command 0
  Identified delay;            ///< s, from the sample's time to the first effect of its command
  Identified time_constant;    ///< s, of the servo's lag
  Identified wheelbase;        ///< m
  Identified understeer;       ///< s^2/m
  double speed_scale = 1;  ///< distance by the poses / distance by the measured speed, where the car hardly
                           ///< turns; 1 if it always turns
  double residual = 0;     ///< rad/s, root mean square of the unexplained yaw rate
  double explained = 0;    ///< explained share of the variance of the yaw change from sample to sample, <= 1
  int samples = 0;         ///< number of yaw changes used
};

/// Fits the model. A gap of more than 0.2 s between samples, a time that does not increase, or a value that
/// is not finite begins a new segment; the first 0.5 s of a segment are not used. Throws
/// std::invalid_argument if fewer than 200 samples are usable or the commands span less than 0.1 rad; the
/// message says what is missing. Throws it also if the wheelbase is negative or `min_speed` not above 0.
Identification identify(std::span<const DrivenSample> samples, const IdentificationOptions& options = {});

}  // namespace slalom::vehicle
