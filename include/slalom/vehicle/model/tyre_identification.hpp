#pragma once

#include <span>

#include "slalom/vehicle/model/identification.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "slalom/vehicle/model/single_track_options.hpp"

namespace slalom::vehicle {

/// The parameters found of tyres and steering.
struct TyreIdentification {
  Identified friction;           ///< mu
  Identified cornering_front;    ///< C_Sf, 1/rad
  Identified cornering_rear;     ///< C_Sr, 1/rad
  Identified steering_gain;      ///< angle of the wheels / commanded angle
  Identified steering_offset;    ///< rad, angle of the wheels at command 0
  Identified delay;              ///< s, from the sample's time to the first effect of its command
  Identified time_constant;      ///< s, of the servo's lag
  double yaw_residual = 0;       ///< rad, root mean square error of the change of yaw in a window
  double sideways_residual = 0;  ///< m, root mean square error of the sideways displacement in a window
  double grip_used = 0;  ///< the share of friction times gravity that v r uses: quantile 0.95 of the windows
  int windows = 0;       ///< number of windows used
};

/// Finds friction and cornering stiffness of a car whose tyres slip, and its steering, from a drive.
///
/// SingleTrackDynamics with the geometry, mass and inertia of `car` and `own` predicts yaw rate and sideways
/// velocity along the whole drive, from the commands and the measured speed. Neither is measured, but their
/// initial values affect a prediction for no longer than a tenth of a second. A least-squares fit compares
/// the predicted change of yaw and sideways displacement of the rear axle, in windows of 0.2 s, with those of
/// the poses. Both are divided by their own root mean square residual; windows further off than five of these
/// (collisions, jumps of the localisation) are left out. The search starts from friction and stiffness of
/// `own`.
///
/// The deviations contain only the noise. Errors of the model add up to about 5 % (measured on the
/// simulator's saturating tyres, without noise).
///
/// While tyres are far from their limit, the drive determines only the products of friction and
/// stiffness: the deviation of the friction is then large. Drive curves close to the limit of grip.
///
/// A gap of more than 0.2 s between samples, a time that does not increase, a speed below
/// `options.min_speed`, or a value that is not finite begins a new segment, whose first 0.5 s are not used.
/// `options.wheelbase` is not used. Throws std::invalid_argument if fewer than 50 windows are usable, the
/// commands span less than 0.1 rad, `options.min_speed` is not above 0, or no prediction is finite, for
/// instance because the mass of the car is 0; the message says what is missing.
TyreIdentification identify_tyres(std::span<const DrivenSample> samples, const PathTrackingOptions& car,
                                  const SingleTrackOptions& own, const IdentificationOptions& options = {});

}  // namespace slalom::vehicle
