#include "bridge/follower/follower_settings.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include "bridge/convert.hpp"
#include "slalom/core/option_access.hpp"

namespace slalom_bridge {
namespace {

using slalom::list_options;
using slalom::OptionEntry;
namespace nav = slalom::navigation;

/// An option of Slalom and its name here.
struct Renamed {
  const char* slalom;
  const char* here;  ///< null: no option here
};
constexpr std::array<Renamed, 8> of_base{{{"base", nullptr},         // motion_model
                                          {"max_reverse", nullptr},  // vx_min
                                          {"max_forward", "vx_max"},
                                          {"max_sideways", "vy_max"},
                                          {"max_turn", "wz_max"},
                                          {"max_acceleration", "ax_max"},
                                          {"max_turn_acceleration", "az_max"},
                                          {"min_turning_radius", "AckermannConstraints/min_turning_r"}}};
constexpr std::array<Renamed, 1> of_navigator{{{"time_step", "model_dt"}}};
constexpr std::array<Renamed, 4> of_method{{{"horizon", "time_steps"},
                                            {"samples", "batch_size"},
                                            {"temperature", "temperature"},
                                            {"gradient_temperature", nullptr}}};  // the same

/// The standard deviation of samples, as a share of the limits, where none is set.
constexpr double usual_share = 0.4;

const Renamed* find_renamed(const Renamed* begin, const Renamed* end, std::string_view slalom_name) {
  const Renamed* const found =
      std::find_if(begin, end, [&](const Renamed& each) { return slalom_name == each.slalom; });
  return found == end ? nullptr : found;
}

/// Whether an option follows from the limits of the base: it has the unit of an input.
bool follows(const OptionEntry& entry) {
  const std::string unit = entry.declaration.unit;
  return unit == "input" || unit == "input^2";
}

/// An option with its name here; an empty name if it is none.
struct Named {
  std::string name;    ///< here
  std::string slalom;  ///< in its options struct
  OptionEntry entry;
};

template <std::size_t count>
Named named(const std::array<Renamed, count>& table, const std::string& section, const OptionEntry& entry) {
  const std::string own = entry.declaration.name;
  if (const Renamed* const found = find_renamed(table.data(), table.data() + count, own))
    return {found->here ? found->here : "", own, entry};
  return {section + own, own, entry};
}

Option plain_named(const Named& option) {
  Option plain_option = plain("", option.entry);
  plain_option.name = option.name;
  return plain_option;
}

std::vector<Named> base_options(const nav::BaseOptions& base) {
  std::vector<Named> all;
  for (const OptionEntry& entry : list_options(base)) all.push_back(named(of_base, "", entry));
  return all;
}
std::vector<Named> cost_options(const nav::CostOptions& costs) {
  std::vector<Named> all;
  for (const OptionEntry& entry : list_options(costs))
    all.push_back({std::string("costs/") + entry.declaration.name, entry.declaration.name, entry});
  return all;
}
/// Without those of base and costs.
std::vector<Named> navigator_options(const nav::NavigatorOptions& options) {
  std::set<std::string> others;
  for (const OptionEntry& entry : list_options(options.base)) others.insert(entry.declaration.name);
  for (const OptionEntry& entry : list_options(options.costs)) others.insert(entry.declaration.name);
  std::vector<Named> all;
  for (const OptionEntry& entry : list_options(options))
    if (others.count(entry.declaration.name) == 0) all.push_back(named(of_navigator, "", entry));
  return all;
}
std::vector<Named> method_options_here(const slalom::SolverOptions& solver) {
  std::vector<Named> all;
  for (const OptionEntry& entry : list_options(solver))
    if (!follows(entry)) all.push_back(named(of_method, std::string(solver.method()) + "/", entry));
  return all;
}

std::string own_name_of(const std::vector<Named>& options, const std::string& name) {
  for (const Named& each : options)
    if (each.name == name) return each.slalom;
  return "";
}

}  // namespace

FollowerSettings::FollowerSettings(std::string method) : method_(std::move(method)) {
  slalom::navigation::method_options(method_, {});  // throws on an unknown method
}

std::vector<Option> FollowerSettings::list() const {
  std::vector<Option> all;
  const auto add = [&](const std::vector<Named>& options) {
    for (const Named& each : options)
      if (!each.name.empty()) all.push_back(plain_named(each));
  };
  for (const OptionEntry& entry : list_options(own_)) all.push_back(plain("", entry));
  add(base_options(navigator_.base));
  add(navigator_options(navigator_));
  add(method_options_here(solver(1)));
  add(cost_options(navigator_.costs));
  return all;
}

void FollowerSettings::set(const std::string& name, const std::string& text) try {
  if (slalom::set_option(own_, name, text)) return;
  if (const auto own = own_name_of(base_options(navigator_.base), name); !own.empty()) {
    slalom::set_option(navigator_.base, own, text);
  } else if (const auto in_costs = own_name_of(cost_options(navigator_.costs), name); !in_costs.empty()) {
    slalom::set_option(navigator_.costs, in_costs, text);
  } else if (const auto in_all = own_name_of(navigator_options(navigator_), name); !in_all.empty()) {
    slalom::set_option(navigator_, in_all, text);
  } else {
    slalom::SolverOptions changed = solver(1);
    const auto of_solver = own_name_of(method_options_here(changed), name);
    if (of_solver.empty()) {
      std::vector<std::string> names;
      for (const Option& each : list()) names.push_back(each.name);
      const std::string nearest = slalom::nearest_name(name, names);
      throw std::invalid_argument("unknown option" +
                                  (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
    }
    slalom::set_option(changed, of_solver, text);
    solver_set_[of_solver] = text;
  }
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument(name + ": " + error.what());
}

nav::BaseOptions FollowerSettings::base(double share) const {
  nav::BaseOptions base = navigator_.base;
  base.kind = static_cast<nav::BaseKind>(own_.motion_model);
  // The least limits that the navigation layer takes.
  constexpr double least = 0.01;
  base.max_forward = std::max(base.max_forward * share, least);
  base.max_turn = std::max(base.max_turn * share, least);
  base.max_reverse = -own_.vx_min * share;
  base.max_sideways *= share;
  return base;
}

nav::NavigatorOptions FollowerSettings::navigator(double share) const {
  nav::NavigatorOptions options = navigator_;
  options.base = base(share);
  return options;
}

slalom::SolverOptions FollowerSettings::solver(double share) const {
  nav::BaseOptions scale = base(share);  // variances are squared shares of these limits
  const auto set_scale = [](double& limit, double deviation) {
    if (deviation > 0) limit = deviation / usual_share;
  };
  set_scale(scale.max_forward, own_.vx_std);
  set_scale(scale.max_sideways, own_.vy_std);
  set_scale(scale.max_turn, own_.wz_std);
  slalom::SolverOptions options = nav::method_options(method_, scale);
  for (const auto& [name, text] : solver_set_) slalom::set_option(options, name, text);
  const double* const temperature = options.find<double>("temperature");
  double* const of_gradient = options.find<double>("gradient_temperature");
  if (temperature && of_gradient) *of_gradient = *temperature;
  return options;
}

}  // namespace slalom_bridge
