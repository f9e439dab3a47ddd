
#include "slalom/core/option_access.hpp"
#include "slalom/vehicle/model/problem_model.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

namespace slalom::vehicle {

namespace {

/// Calls `use.template operator()<i>()` for the model with index i that `options` name.
template <std::size_t i = 0, class Use>
auto with_model(const VehicleOptions& options, Use&& use) {
  if constexpr (i + 1 < VehicleModels::size) {
    if (static_cast<std::size_t>(options.model) != i) return with_model<i + 1>(options, use);
  }
  return use.template operator()<i>();
}

template <std::size_t i>
std::unique_ptr<VehicleModel> make_indexed(const VehicleOptions& options, simd::Target target) {
  using Model = VehicleModels::At<i>;
  const auto make = [&]<class P>(P problem) -> std::unique_ptr<VehicleModel> {
    if constexpr (DynamicVehicleProblem<P>)
      return std::make_unique<DynamicProblemModel<P>>(std::move(problem), target);
    else
      return std::make_unique<ProblemModel<P>>(std::move(problem), target);
  };
  if constexpr (requires { Model::with_problem(options, std::get<i>(options.own), make); }) {
    return Model::with_problem(options, std::get<i>(options.own), make);
  } else {
    return make(Model(options, std::get<i>(options.own)));
  }
}

/// Throws where an option of another model is set, which would have no effect.
template <std::size_t i = 0>
void check_own_options(const VehicleOptions& options) {
  using Own = std::tuple_element_t<i, VehicleModels::Options>;
  if (static_cast<std::size_t>(options.model) != i) {
    const auto set = list_options(std::get<i>(options.own)), standard = list_options(Own{});
    for (std::size_t k = 0; k < set.size(); ++k) {
      if (set[k] == standard[k]) continue;
      throw std::invalid_argument("vehicle." + std::string(set[k].declaration.name) + ": '" +
                                  to_text(set[k].value) + "' is an option of vehicle.model '" +
                                  VehicleModels::names[i] + "', but vehicle.model is '" +
                                  VehicleModels::names[static_cast<std::size_t>(options.model)] + "'");
    }
  }
  if constexpr (i + 1 < VehicleModels::size) check_own_options<i + 1>(options);
}

}  // namespace

VehicleModelId vehicle_model(std::string_view name) {
  std::string all;
  for (std::size_t i = 0; i < VehicleModels::size; ++i) {
    if (name == VehicleModels::names[i]) return static_cast<VehicleModelId>(i);
    all += (i > 0 ? ", " : "") + std::string(VehicleModels::names[i]);
  }
  throw std::invalid_argument("vehicle.model: '" + std::string(name) + "' must be one of " + all);
}

int input_count(const VehicleOptions& options) noexcept {
  return with_model(options, []<std::size_t i>() { return VehicleModels::At<i>::inputs; });
}

std::string input_names(const VehicleOptions& options) {
  return with_model(options, []<std::size_t i>() {
    std::string text;
    for (const char* name : VehicleModels::At<i>::input_names)
      text += (text.empty() ? "" : " and ") + std::string(name);
    return text;
  });
}

std::unique_ptr<VehicleModel> make_vehicle_model(const VehicleOptions& options, simd::Target target) {
  validate_options(options, "vehicle");
  check_own_options(options);
  return with_model(options, [&]<std::size_t i>() { return make_indexed<i>(options, target); });
}

}  // namespace slalom::vehicle
