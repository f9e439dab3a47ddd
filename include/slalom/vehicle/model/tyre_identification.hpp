#pragma once

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
/// SingleTrackDynamics with the geometry, mass and inertia of `car` and `own` predicts the whole drive from
/// the commands and the measured speed. A least-squares fit compares the predicted change of yaw and sideways
/// displacement of the rear axle, in windows of 0.2 s, with those of the poses, each over its own root mean
/// square residual. Windows further off than five of these are left out. The search starts from friction and
/// stiffness of `own`.
///
/// The deviations contain only the noise; errors of the model add up to about 5 %. Far from the limit of the
/// tyres, the drive determines only the products of friction and stiffness, and the deviation of the friction
/// is large: drive curves close to the limit of grip.
///
/// Segments are those of identify(), and a speed below `options.min_speed` also begins one;
/// `options.wheelbase` is not used. Throws std::invalid_argument if fewer than 50 windows are usable, the
/// commands span less than 0.1 rad, `options.min_speed` is not above 0, or no prediction is finite.
TyreIdentification identify_tyres(std::span<const DrivenSample> samples, const PathTrackingOptions& car,
                                  const SingleTrackOptions& own, const IdentificationOptions& options = {});

}  // namespace slalom::vehicle
