#pragma once

#include <map>

#include "logic/named_option.hpp"
#include "logic/others_watch.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::nodes {

/// The kinds of bases with the names of nav2's MPPI controller, in the order of navigation::BaseKind.
enum class Nav2BaseKind { DiffDrive, Omni, Ackermann };
inline const char* const* enum_names(Nav2BaseKind) {
  static constexpr const char* const names[] = {"DiffDrive", "Omni", "Ackermann", nullptr};
  return names;
}

/// The options of nav2's MPPI controller that the navigation layer has not, or has in another form.
/// `visit_options` below describes the fields.
struct FollowerOptions {
  Nav2BaseKind motion_model = Nav2BaseKind::DiffDrive;
  double vx_min = -0.35;
  double vx_std = 0;
  double vy_std = 0;
  double wz_std = 0;
  bool open_loop = false;
  navigation::UnknownCells unknown_cells = navigation::UnknownCells::priced;
  OthersFrom others = OthersFrom::none;
  double cell_price = 2;
  bool visualize = false;
  double transform_tolerance = 0.1;
};

template <class Options, class Visit>
requires is_options_of<Options, FollowerOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.motion_model, {"motion_model", "", "how the base can move"});
  visit(o.vx_min, {"vx_min", "m/s", "lowest speed forward; below 0 the base may reverse", -20, 0});
  visit(o.vx_std,
        {"vx_std", "m/s", "standard deviation of the sampled speeds forward; 0: 0.4 vx_max", 0, 100});
  visit(o.vy_std,
        {"vy_std", "m/s", "standard deviation of the sampled speeds sideways; 0: 0.4 vy_max", 0, 100});
  visit(o.wz_std, {"wz_std", "rad/s", "standard deviation of the sampled yaw rates; 0: 0.2 wz_max", 0, 100});
  visit(o.open_loop, {"open_loop", "", "plan from the last command instead of the measured velocity"});
  visit(o.unknown_cells, {"unknown_cells", "",
                          "unknown cells and what lies off the costmap: obstacles, or places with a price"});
  visit(o.others, {"others", "", "where it learns of people: nowhere, from scans, or from a topic"});
  visit(o.cell_price, {"cell_price", "",
                       "price of a cell with cost 252, as of an unknown cell; falls with the square of the "
                       "cost; 0: only obstacles count",
                       0, 1000});
  visit(o.visualize, {"visualize", "", "publish plan, followed path, cost terms and samples"});
  visit(o.transform_tolerance,
        {"transform_tolerance", "s", "time to wait for a transform at the time of a pose", 0, 60});
}

/// The options of a path follower under the names of nav2's MPPI controller where they mean the same, and
/// under those of the navigation layer elsewhere: the weights of the cost in the section "costs", the other
/// options of the method in a section of the method's name. Variances and bounds of inputs are no options:
/// they follow from the limits of the base and the standard deviations.
class FollowerSettings {
 public:
  /// Throws std::invalid_argument that lists the names if the method is unknown.
  explicit FollowerSettings(std::string method);

  /// All options, with their values, ranges and rules.
  std::vector<NamedOption> list() const;
  /// Sets an option from text, or throws std::invalid_argument with name, value and rule.
  void set(const std::string& name, const std::string& text);

  /// The options that the navigation layer has not.
  const FollowerOptions& own() const { return own_; }
  /// The largest speed forward, m/s.
  double max_forward() const { return navigator_.base.max_forward; }
  /// The options of a navigator whose speeds are at most this share of the limits, in (0, 1].
  navigation::NavigatorOptions navigator(double share) const;
  /// The options of its solver. Throws std::invalid_argument.
  SolverOptions solver(double share) const;

 private:
  template <class Visit>
  void visit(Visit&& visit) const;
  navigation::BaseOptions base(double share) const;

  std::string method_;
  FollowerOptions own_;
  navigation::NavigatorOptions navigator_;
  std::map<std::string, std::string> solver_set_;  ///< options of the method that were set, by their names
};

}  // namespace slalom::nodes
