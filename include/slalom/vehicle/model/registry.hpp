#pragma once

#include <array>
#include <cstddef>
#include <tuple>

#include "slalom/vehicle/model/kinematic.hpp"
#include "slalom/vehicle/model/path_tracking.hpp"
#include "slalom/vehicle/published/path_tracking.hpp"

/// Every vehicle model that `vehicle.model` can name. A new one is a header with a motion model (see
/// PathTracking) or a vehicle problem (see VehicleProblem) and a line here.
namespace slalom::vehicle {

template <class... Models>
struct ModelList {
  using Options = std::tuple<typename Models::Options...>;
  static constexpr std::size_t size = sizeof...(Models);
  static constexpr std::array<const char*, size + 1> names{Models::name..., nullptr};
  template <std::size_t i>
  using At = std::tuple_element_t<i, std::tuple<Models...>>;
};

/// The first one is the default.
using VehicleModels = ModelList<PathTracking<Kinematic>,              //
                                PathTracking<KinematicAcceleration>,  //
                                published::Model>;

}  // namespace slalom::vehicle
