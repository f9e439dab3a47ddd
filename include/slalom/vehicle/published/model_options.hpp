#pragma once

#include "slalom/core/options.hpp"

/// The vehicle problem of the program that the authors of Honda et al. (ICRA 2024) published, with its
/// departures from the paper and from the car. It exists to reproduce their results.
namespace slalom::vehicle::published {

/// Reference point and yaw gain of the bicycle.
enum class BicycleModel {
  rear_axle,  ///< as in KinematicBicycle
  published,  ///< tan(b) = l_f / (l_f + l_r) tan(steer), x' = v cos(yaw + b), yaw' = v sin(b) / l_r. About
              ///< the centre of gravity, tan(b) has l_r in its numerator (Rajamani, "Vehicle Dynamics and
              ///< Control", 2nd ed., section 2.2): the yaw gain of this form is too high
};
inline const char* const* enum_names(BicycleModel) {
  static constexpr const char* const names[] = {"rear_axle", "published", nullptr};
  return names;
}

/// Options of `vehicle.model: published` besides those of every model. The defaults are the correct forms.
/// `visit_options` below describes the fields.
struct ModelOptions {
  BicycleModel bicycle = BicycleModel::rear_axle;
  bool exact_lag = true;
  bool straight_local_rollout = false;
  bool linear_sign_error = false;

  bool operator==(const ModelOptions&) const = default;

  /// The values of the published program.
  static ModelOptions published() {
    return {.bicycle = BicycleModel::published,
            .exact_lag = false,
            .straight_local_rollout = true,
            .linear_sign_error = true};
  }
};

template <class Options, class Visit>
requires is_options_of<Options, ModelOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.bicycle, {"bicycle", "", "model `published`: reference point and yaw gain of the bicycle"});
  visit(o.exact_lag,
        {"exact_lag", "", "model `published`: steering lag discretised exactly, not by explicit Euler"});
  visit(o.straight_local_rollout,
        {"straight_local_rollout", "",
         "model `published`: collisions along a second rollout that starts with straight wheels"});
  visit(o.linear_sign_error, {"linear_sign_error", "",
                              "model `published`: with `speed: linear` a car that is too fast accelerates"});
}

}  // namespace slalom::vehicle::published
