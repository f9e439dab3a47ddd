#include "logic/follower_settings.hpp"

#include <set>

namespace slalom::nodes {
namespace {

namespace nav = navigation;

/// The owner of an option.
enum class Owner { follower, navigator, method };

/// An option of the navigation layer, and its name here; null if it is no option here.
struct Renamed {
  std::string_view name;
  const char* here;
};
constexpr Renamed renamed_options[] = {{"base", nullptr},         // motion_model
                                       {"max_reverse", nullptr},  // vx_min
                                       {"max_forward", "vx_max"},
                                       {"max_sideways", "vy_max"},
                                       {"max_turn", "wz_max"},
                                       {"max_acceleration", "ax_max"},
                                       {"max_sideways_acceleration", "ay_max"},
                                       {"max_turn_acceleration", "az_max"},
                                       {"min_turning_radius", "AckermannConstraints.min_turning_r"},
                                       {"time_step", "model_dt"},
                                       {"retries", "retry_attempt_limit"}};
/// The same for options of the method.
constexpr Renamed renamed_of_method[] = {{"horizon", "time_steps"},
                                         {"samples", "batch_size"},
                                         {"temperature", "temperature"},
                                         {"gradient_temperature", nullptr}};  // temperature

/// The standard deviations of samples, as shares of the limits of speeds and yaw rate, where none is set.
constexpr double usual_share = 0.4, usual_turn_share = 0.2;

/// The name of an option here: that of a table, or `section` + `name`; empty if it is no option here.
std::string name_here(std::span<const Renamed> table, const std::string& section, std::string_view name) {
  for (const Renamed& each : table)
    if (each.name == name) return each.here ? each.here : "";
  return section + std::string(name);
}

/// Whether an option follows from the limits of the base: it has the unit of an input.
bool follows(const OptionEntry& entry) {
  const std::string_view unit = entry.declaration.unit;
  return unit == "input" || unit == "input^2";
}

}  // namespace

FollowerSettings::FollowerSettings(std::string method) : method_(std::move(method)) {
  nav::method_options(method_, {});  // throws on an unknown method
  navigator_.retries = 1;
}

/// Calls `visit(owner, option)` for every option.
template <class Visit>
void FollowerSettings::visit(Visit&& visit) const {
  const auto add = [&](Owner owner, std::string name, const OptionEntry& entry) {
    if (!name.empty()) visit(owner, NamedOption{std::move(name), entry});
  };
  for (const OptionEntry& entry : list_options(own_)) add(Owner::follower, entry.declaration.name, entry);
  std::set<std::string_view> costs;
  for (const OptionEntry& entry : list_options(navigator_.costs)) costs.insert(entry.declaration.name);
  for (const OptionEntry& entry : list_options(navigator_)) {
    const char* const section = costs.count(entry.declaration.name) > 0 ? "costs." : "";
    add(Owner::navigator, name_here(renamed_options, section, entry.declaration.name), entry);
  }
  for (const OptionEntry& entry : list_options(solver(1)))
    if (!follows(entry))
      add(Owner::method, name_here(renamed_of_method, method_ + ".", entry.declaration.name), entry);
}

std::vector<NamedOption> FollowerSettings::list() const {
  std::vector<NamedOption> all;
  visit([&](Owner, NamedOption option) { all.push_back(std::move(option)); });
  return all;
}

void FollowerSettings::set(const std::string& name, const std::string& text) try {
  std::vector<std::string> names;
  const char* found = nullptr;
  Owner owner{};
  visit([&](Owner of, const NamedOption& option) {
    names.push_back(option.name);
    if (option.name != name) return;
    found = option.entry.declaration.name;
    owner = of;
  });
  if (!found) {
    const std::string nearest = nearest_name(name, names);
    throw std::invalid_argument("unknown option" +
                                (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
  }
  if (owner == Owner::follower) set_option(own_, found, text);
  if (owner == Owner::navigator) set_option(navigator_, found, text);
  if (owner != Owner::method) return;
  SolverOptions changed = solver(1);
  set_option(changed, found, text);
  solver_set_[found] = text;
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument(name + ": " + error.what());
}

nav::BaseOptions FollowerSettings::base(double share) const {
  nav::BaseOptions base = navigator_.base;
  base.kind = static_cast<nav::BaseKind>(own_.motion_model);
  // The least limits that the navigation layer takes.
  constexpr double least = 0.01;
  base.max_forward = std::max(base.max_forward * share, least);
  if (base.max_turn > 0) base.max_turn = std::max(base.max_turn * share, least);
  base.max_reverse = -own_.vx_min * share;
  base.max_sideways *= share;
  return base;
}

nav::NavigatorOptions FollowerSettings::navigator(double share) const {
  nav::NavigatorOptions options = navigator_;
  options.base = base(share);
  return options;
}

SolverOptions FollowerSettings::solver(double share) const {
  nav::BaseOptions scale = base(share);  // variances are squared shares of these limits
  const auto set_scale = [](double& limit, double deviation, double usual) {
    if (deviation > 0) limit = deviation / usual;
  };
  set_scale(scale.max_forward, own_.vx_std, usual_share);
  set_scale(scale.max_sideways, own_.vy_std, usual_share);
  set_scale(scale.max_turn, own_.wz_std, usual_turn_share);
  SolverOptions options = nav::method_options(method_, scale);
  for (const auto& [name, text] : solver_set_) set_option(options, name, text);
  const double* const temperature = options.find<double>("temperature");
  double* const of_gradient = options.find<double>("gradient_temperature");
  if (temperature && of_gradient) *of_gradient = *temperature;
  return options;
}

}  // namespace slalom::nodes
