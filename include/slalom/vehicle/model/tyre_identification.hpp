#pragma once

#include <span>

#include "slalom/vehicle/model/identification.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "slalom/vehicle/model/single_track_options.hpp"

namespace slalom::vehicle {

/// What is found of tyres and steering.
struct TyreIdentification {
  Identified friction;           ///< mu
  Identified cornering_front;    ///< C_Sf, 1/rad
  Identified cornering_rear;     ///< C_Sr, 1/rad
  Identified steering_gain;      ///< angle of the wheels / commanded angle
  Identified steering_offset;    ///< rad, angle of the wheels at command 0
  Identified delay;              ///< s, from the sample's time to the first effect of its command
  Identified time_constant;      ///< s, of the servo's lag
  double yaw_residual = 0;       ///< rad, root mean square error of the turn in a window
  double sideways_residual = 0;  ///< m, root mean square error of the way sideways in a window
  double grip_used = 0;  ///< share of friction times gravity that v r uses; a twentieth of the windows more
  int windows = 0;       ///< number of windows used
};

/// Finds friction and cornering stiffness of a car whose tyres slip, and its steering, from a drive.
///
/// SingleTrackDynamics with the geometry, mass and inertia of `car` and `own` predicts yaw rate and sideways
/// velocity along the whole drive, from the commands and the measured speed. Neither is measured: whatever a
/// prediction begins with is forgotten within a tenth of a second. The fit compares, in windows of 0.2 s, the
/// turn and the way sideways of the rear axle with those of the poses, by least squares. Each is weighed by
/// its own residual; windows further off than five deviations (collisions, jumps of the localisation) are
/// left out. Friction and stiffness of `own` are where the search starts.
///
/// Deviations are those of the noise. What the model leaves out adds up to about 5 % (the simulator's own
/// saturating tyres, without noise).
///
/// As long as tyres are far from their limit, the drive determines only the products of friction and
/// stiffness: the deviation of the friction is then large. Drive curves close to the limit of grip.
///
/// A gap of more than 0.2 s between samples, a time that does not increase, a speed below
/// `options.min_speed`, or a value that is not finite begins a new segment, whose first 0.5 s are not used.
/// `options.wheelbase` is not used. Throws std::invalid_argument if fewer than 50 windows are usable, the
/// commands span less than 0.1 rad, or an option is out of range; the message says what is missing.
TyreIdentification identify_tyres(std::span<const DrivenSample> samples, const PathTrackingOptions& car,
                                  const SingleTrackOptions& own, const IdentificationOptions& options = {});

}  // namespace slalom::vehicle
