#pragma once

#include <span>

/// What a car's steering does, from a drive: its gain, trim, delay and lag, and the car's wheelbase.
///
/// The model is the kinematic bicycle of the vehicle problem with a servo before it and with understeer,
///
///     steer' = (gain u(t - delay) + offset - steer) / time_constant
///     yaw'   = v tan(steer) / (wheelbase + understeer v^2)
///
/// (R. Rajamani, "Vehicle Dynamics and Control", 2nd ed., eq. 2.2 and 3.13), fitted to how far the pose
/// turned from one sample to the next by least squares (Levenberg 1944, Marquardt 1963). Gain and wheelbase
/// are told apart only by the curvature of the tangent, so a wheelbase that was measured with a ruler should
/// be given.
namespace slalom::vehicle {

/// What was known at one control step.
struct DrivenSample {
  double time = 0;           ///< s
  double x = 0, y = 0;       ///< m, of the rear axle, map frame
  double yaw = 0;            ///< rad; must not come from the steering, as that of plain wheel odometry does
  double speed = 0;          ///< m/s, as measured
  double steer_command = 0;  ///< rad, sent now
};

struct IdentificationOptions {
  double wheelbase = 0;      ///< m; 0: sought too
  double least_speed = 0.5;  ///< m/s, below it a sample says too little
};

/// A value and its standard deviation, which is 0 where the value was given.
struct Identified {
  double value = 0;
  double deviation = 0;
};

struct Identification {
  Identified steering_gain;    ///< wheels' angle over the commanded
  Identified steering_offset;  ///< rad
  Identified delay;            ///< s, from the sample's time to the first effect of its command
  Identified time_constant;    ///< s
  Identified wheelbase;        ///< m
  Identified understeer;       ///< s^2/m
  double speed_scale = 1;      ///< way by the poses over way by the measured speed
  double residual = 0;         ///< rad/s, root mean square of the yaw rate that is not explained
  double explained = 0;        ///< share of the yaw rate's variance that is, 0 .. 1
  int samples = 0;             ///< used
};

/// Fits the model. A gap of more than 0.2 s between samples, or a time that goes back, begins a new piece.
/// Throws std::invalid_argument where there are fewer than 200 usable samples or the steering hardly moves,
/// naming what is missing.
Identification identify(std::span<const DrivenSample> samples, const IdentificationOptions& options = {});

}  // namespace slalom::vehicle
