#pragma once

#include <tuple>

#include "slalom/vehicle/model/kinematic.hpp"
#include "slalom/vehicle/model/path_tracking.hpp"
#include "slalom/vehicle/model/single_track.hpp"
#include "slalom/vehicle/published/path_tracking.hpp"

/// Every vehicle model that `vehicle.model` can name. A new one is a header with a motion model (see
/// PathTracking) or a vehicle problem (see VehicleProblem) and a line here.
namespace slalom::vehicle {

/// A list of vehicle models.
template <class... Models>
struct ModelList {
  using Options = std::tuple<typename Models::Options...>;  ///< the options of all models
  /// Number of models.
  static constexpr std::size_t size = sizeof...(Models);
  /// Names of the models, then null.
  static constexpr std::array<const char*, size + 1> names{Models::name..., nullptr};
  template <std::size_t i>
  using At = std::tuple_element_t<i, std::tuple<Models...>>;  ///< the model with an index
};

/// The first one is the default.
using VehicleModels = ModelList<PathTracking<Kinematic>,              //
                                PathTracking<KinematicAcceleration>,  //
                                PathTracking<SingleTrack>,            //
                                published::Model>;

}  // namespace slalom::vehicle
