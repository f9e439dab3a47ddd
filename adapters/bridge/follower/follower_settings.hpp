#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/bridge.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom_bridge {

/// How a base moves, by the names of nav2's MPPI controller; in the order of slalom::navigation::BaseKind.
enum class MotionModel { DiffDrive, Omni, Ackermann };
/// The names of the enumerators, in order.
inline const char* const* enum_names(MotionModel) {
  static constexpr const char* const names[] = {"DiffDrive", "Omni", "Ackermann", nullptr};
  return names;
}

/// What nav2's MPPI controller has and the navigation layer has not, or has in another form.
struct FollowerOptions {
  MotionModel motion_model = MotionModel::DiffDrive;  ///< how the base moves
  double vx_min = -0.35;                              ///< m/s, speed forward; negative: it may reverse
  double vx_std = 0;                                  ///< m/s, of the samples; 0: 0.4 vx_max
  double vy_std = 0;                                  ///< m/s, the same
  double wz_std = 0;                                  ///< rad/s, the same
  bool open_loop = false;                             ///< plan from the last command, not the odometry
  slalom::navigation::UnknownCells unknown_cells =
      slalom::navigation::UnknownCells::priced;  ///< what the robot may do there
  bool visualize = false;                        ///< for the node: publish what is planned and followed
  double transform_tolerance = 0.1;              ///< s, for the node
};

/// Declares the options above.
template <class Options, class Visit>
requires slalom::is_options_of<Options, FollowerOptions>
void visit_options(Options& o, Visit&& visit) {
  using slalom::Declaration;
  const auto deviation = [&](auto& field, const char* name, const char* unit, const char* help) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help, .min = 0, .max = 100});
  };
  visit(o.motion_model, Declaration{.name = "motion_model", .help = "how the base can move"});
  visit(o.vx_min, Declaration{.name = "vx_min",
                              .unit = "m/s",
                              .help = "lowest speed forward; below 0 the base may reverse",
                              .min = -20,
                              .max = 0});
  deviation(o.vx_std, "vx_std", "m/s", "standard deviation of the sampled speeds forward; 0: 0.4 vx_max");
  deviation(o.vy_std, "vy_std", "m/s", "standard deviation of the sampled speeds sideways; 0: 0.4 vy_max");
  deviation(o.wz_std, "wz_std", "rad/s", "standard deviation of the sampled yaw rates; 0: 0.4 wz_max");
  visit(o.open_loop, Declaration{.name = "open_loop",
                                 .help = "plan from the last command instead of the measured velocity"});
  visit(o.unknown_cells,
        Declaration{.name = "unknown_cells",
                    .help = "whether unknown cells and what lies off the costmap are obstacles or have a "
                            "price"});
  visit(o.visualize,
        Declaration{.name = "visualize", .help = "publish local_plan and transformed_global_plan"});
  visit(o.transform_tolerance, Declaration{.name = "transform_tolerance",
                                           .unit = "s",
                                           .help = "time to wait for a transform at the time of a pose",
                                           .min = 0,
                                           .max = 60});
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
  std::vector<Option> list() const;
  /// Sets an option from text. Throws std::invalid_argument with name, value and rule; nothing has changed
  /// then.
  void set(const std::string& name, const std::string& text);

  const FollowerOptions& own() const { return own_; }  ///< those that the navigation layer has not
  /// The largest speed forward, m/s.
  double max_forward() const { return navigator_.base.max_forward; }
  /// For a navigator whose speeds are at most this share of the limits, in (0, 1].
  slalom::navigation::NavigatorOptions navigator(double share) const;
  /// The same for its solver. Throws std::invalid_argument.
  slalom::SolverOptions solver(double share) const;

 private:
  slalom::navigation::BaseOptions base(double share) const;

  std::string method_;
  FollowerOptions own_;
  slalom::navigation::NavigatorOptions navigator_;
  std::map<std::string, std::string> solver_set_;  ///< options of the method that were set, by their names
};

}  // namespace slalom_bridge
