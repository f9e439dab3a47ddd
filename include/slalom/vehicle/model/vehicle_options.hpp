#pragma once

#include "slalom/vehicle/model/registry.hpp"

namespace slalom::vehicle {

/// A registered vehicle model: its index in VehicleModels, and by enum_names its name.
enum class VehicleModelId : int {};
/// The names of the registered models, in order.
inline const char* const* enum_names(VehicleModelId) {
  return VehicleModels::names.data();
}

/// The model of this name. Throws std::invalid_argument that lists the names.
VehicleModelId vehicle_model(std::string_view name);

/// The options of the car: which model it has, the options that all models share, and each model's own.
/// `visit_options` below describes the fields.
struct VehicleOptions : PathTrackingOptions {
  VehicleModelId model{};
  VehicleModels::Options own;  ///< each model's own options

  /// The own options of a registered model, by their type.
  template <class Options>
  Options& own_of() {
    return std::get<Options>(own);
  }
  /// The own options of a registered model, by their type.
  template <class Options>
  const Options& own_of() const {
    return std::get<Options>(own);
  }
};

/// Declares the model, the shared options and those of every model's own.
template <class Options, class Visit>
requires is_options_of<Options, VehicleOptions>
void visit_options(Options& o, Visit&& visit) {
  using Shared = std::conditional_t<std::is_const_v<Options>, const PathTrackingOptions, PathTrackingOptions>;
  visit(o.model, {"model", "", "how the car moves, and what its inputs are"});
  visit_options(static_cast<Shared&>(o), visit);
  std::apply([&](auto&... own) { (visit_options(own, visit), ...); }, o.own);
}

/// The number of inputs of the model.
int input_count(const VehicleOptions& options) noexcept;
/// The names of its inputs, for instance "steering and acceleration".
std::string input_names(const VehicleOptions& options);

}  // namespace slalom::vehicle
