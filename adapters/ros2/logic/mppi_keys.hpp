#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

/// The parameters of nav2's MPPI controller (nav2 1.3).
namespace slalom::nodes::mppi_keys {

/// The parameters that mean the same here, under the same name.
inline constexpr std::array taken{"motion_model",
                                  "time_steps",
                                  "model_dt",
                                  "batch_size",
                                  "vx_max",
                                  "vx_min",
                                  "vy_max",
                                  "wz_max",
                                  "az_max",
                                  "vx_std",
                                  "vy_std",
                                  "wz_std",
                                  "open_loop",
                                  "visualize",
                                  "transform_tolerance",
                                  "AckermannConstraints.min_turning_r"};

/// A key that has no meaning here; with a dot at its end, a section of such keys.
struct Dropped {
  const char* key;
  const char* why;
};
inline constexpr std::array dropped{
    Dropped{"ax_max", "one limit holds in all directions: ax_max, the least of these"},
    Dropped{"ax_min", "one limit holds in all directions: ax_max, the least of these"},
    Dropped{"ay_max", "one limit holds in all directions: ax_max, the least of these for an Omni base"},
    Dropped{"ay_min", "one limit holds in all directions: ax_max, the least of these for an Omni base"},
    Dropped{"iteration_count", "there is one solve in a period; svg_mppi.guide_iterations moves its guides"},
    Dropped{"gamma", "the weights have no control cost; svg_mppi.control_cost_discount would add it"},
    Dropped{"retry_attempt_limit", "patience is the time that there may be no way"},
    Dropped{"regenerate_noises", "the noise is drawn anew in every solve"},
    Dropped{"prune_distance", "the path counts as far as the robot can drive in a plan"},
    Dropped{"max_robot_pose_search_dist", "the nearest pose is searched in the next 3 m of the path"},
    Dropped{"enforce_path_inversion", "plans may reverse wherever that costs less"},
    Dropped{"inversion_xy_tolerance", "plans may reverse wherever that costs less"},
    Dropped{"inversion_yaw_tolerance", "plans may reverse wherever that costs less"},
    Dropped{"critics", "the terms of the cost are fixed; their weights are in costs"},
    Dropped{"TrajectoryVisualizer.", "visualize publishes the plan, not the samples"},
    Dropped{"ConstraintCritic.", "samples keep to the limits of speed and acceleration"},
    Dropped{"CostCritic.", "distances to obstacles count, not costs of cells: costs.clearance"},
    Dropped{"ObstaclesCritic.", "distances to obstacles count, not costs of cells: costs.clearance"},
    Dropped{"GoalCritic.", "costs.progress and costs.final_progress draw the robot to the goal"},
    Dropped{"GoalAngleCritic.", "the cost has another scale: costs.goal_heading"},
    Dropped{"PathAlignCritic.", "the cost has another scale: costs.path"},
    Dropped{"PathFollowCritic.", "the cost has another scale: costs.progress"},
    Dropped{"PathAngleCritic.", "the cost has another scale: costs.heading"},
    Dropped{"PreferForwardCritic.", "the cost has another scale: costs.reverse"},
    Dropped{"TwirlingCritic.", "the cost has another scale: costs.turning"},
    Dropped{"VelocityDeadbandCritic.", "there is no term for slow motion"},
};

/// Whether a key means the same here.
inline bool is_taken(std::string_view key) {
  return std::find(taken.begin(), taken.end(), key) != taken.end();
}
/// The reason why a key is dropped; null if it is not.
inline const char* why_dropped(std::string_view key) {
  for (const Dropped& each : dropped) {
    const std::string_view name = each.key;
    if (name.back() == '.' ? key.substr(0, name.size()) == name : key == name) return each.why;
  }
  return nullptr;
}
/// The names of all keys; for a section that is dropped, the name of the section.
inline std::vector<std::string> all() {
  std::vector<std::string> names(taken.begin(), taken.end());
  names.insert(names.end(), {"temperature", "plugin"});
  for (const Dropped& each : dropped) {
    names.emplace_back(each.key);
    if (names.back().back() == '.') names.back().pop_back();
  }
  return names;
}

}  // namespace slalom::nodes::mppi_keys
