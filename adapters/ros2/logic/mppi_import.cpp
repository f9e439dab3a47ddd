#include "logic/mppi_import.hpp"

#include <set>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "logic/follower_settings.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/maps/yaml_text.hpp"

namespace slalom::nodes {
namespace {

constexpr const char* mppi = "nav2_mppi_controller::MPPIController";

/// A name in nav2, and the name here.
struct Name {
  const char *there, *here;
};

constexpr Name renamed[] = {{"GoalAngleCritic.threshold_to_consider", "costs.goal_reach"},
                            {"model_delay_vx", "delay_forward"},
                            {"model_delay_vy", "delay_sideways"},
                            {"model_delay_wz", "delay_turn"}};

/// Limits of braking, which are negative there.
constexpr Name braking[] = {{"ax_min", "max_deceleration"}, {"ay_min", "max_sideways_deceleration"}};

/// A parameter that has no meaning here, and the reason; with a dot at its end, a section of such parameters.
struct Dropped {
  const char* key;
  const char* why;
};
constexpr const char* every_cusp =
    "the robot drives to every cusp, and reverses where the yaws of the path say so";
constexpr const char* distances_count =
    "distances to obstacles count (costs.clearance), and costs of cells as prices (cell_price)";
constexpr Dropped dropped[] = {
    {"iteration_count", "there is one solve in a period; svg_mppi.guide_iterations moves its guides"},
    {"gamma", "the weights have no control cost; svg_mppi.control_cost_discount would add it"},
    {"regenerate_noises", "the noise is drawn anew in every solve"},
    {"prune_distance", "the path counts as far as the robot can drive in a plan"},
    {"max_robot_pose_search_dist", "the nearest pose is searched 0.3 m back and 1 m ahead on the path"},
    {"enforce_path_inversion", every_cusp},
    {"inversion_xy_tolerance", every_cusp},
    {"inversion_yaw_tolerance", every_cusp},
    {"sgf_order", "samples are smooth: svg_mppi.noise_exponent"},
    {"clamp_raw_controls", "all samples keep to the limits"},
    {"publish_optimal_trajectory", "visualize publishes the plan"},
    {"publish_critics_stats", "visualize publishes the cost of the plan by its terms"},
    {"critic_index_to_visualize", "visualize publishes the cost of the plan by its terms"},
    {"TrajectoryValidator.", "the plan is always checked with the footprint, until the robot can brake"},
    {"PathHandler.", "the path counts as far as the robot can drive in a plan"},
    {"critics", "the terms of the cost are fixed; their weights are in costs"},
    {"TrajectoryVisualizer.", "visualize publishes the plan and 100 samples"},
    {"ConstraintCritic.", "samples keep to the limits of speed and acceleration"},
    {"CostCritic.", distances_count},
    {"ObstaclesCritic.", distances_count},
    {"GoalCritic.", "costs.progress and costs.final_progress draw the robot to the goal"},
    {"GoalAngleCritic.", "the cost has another scale: costs.goal_heading"},
    {"PathAlignCritic.", "the cost has another scale: costs.path"},
    {"PathFollowCritic.", "the cost has another scale: costs.progress"},
    {"PathAngleCritic.", "the cost has another scale: costs.heading"},
    {"PreferForwardCritic.", "the cost has another scale: costs.reverse"},
    {"TwirlingCritic.", "the cost has another scale: costs.turning"},
    {"VelocityDeadbandCritic.", "commands keep out of the dead bands: dead_band_forward"},
};

constexpr const char* dead_bands = "VelocityDeadbandCritic.deadband_velocities";

/// The name here of a name in nav2; null if the table has none.
const char* other_name(std::span<const Name> table, const std::string& key) {
  const auto found = std::ranges::find(table, key, &Name::there);
  return found == table.end() ? nullptr : found->here;
}

/// A key of a section, with dots between sections, and its value in the file.
struct Given {
  std::string key;
  int line;  ///< from 1
  YAML::Node value;
};

/// The import of one section.
class Section {
 public:
  Section(std::string file, std::string name, int line, const YAML::Node& node)
      : file_(std::move(file)), name_(std::move(name)), line_(line) {
    flatten(node, "");
  }

  void import(MppiImport& to) {
    for (const Given& given : given_) {
      std::string fate;
      if (const char* const limit = other_name(braking, given.key))
        fate = take(given, limit, to_text(std::abs(number_of(given))), "the name here");
      else if (given.key == dead_bands)
        fate = take_dead_bands(given);
      else if (given.key == "plugin")
        fate = "changed to plugin: slalom_nav2::Controller";
      else if (given.key == "temperature")
        fate = take(given, "temperature", temperature(given),
                    "costs have another scale; its ratio to the default is kept");
      else if (given.key == "motion_model")
        fate = take(given, given.key, model(), "the name here");
      else if (given.key == model_key() + ".plugin")
        fate = "taken as motion_model";
      else if (given.key == model_key() + ".min_turning_r")
        fate = take(given, "AckermannConstraints.min_turning_r", text_of(given), "the name here");
      else if (given.key == "wz_std" && number_of(given) == 0)
        fate = take(given, "wz_max", "0", "the robot does not turn");
      else if (given.key == "wz_max" && no_turn_sampled())
        fate = "dropped (wz_std: 0 counts)";
      else if (const char* const other = other_name(renamed, given.key))
        fate = take(given, other, text_of(given), "the name here");
      else if (is_option(given.key))
        fate = take(given, given.key, text_of(given), "");
      else
        fate = fate_of(given.key);
      const std::string value = given.value.IsScalar()     ? given.value.Scalar()
                                : given.value.IsSequence() ? "a list"
                                                           : "nothing";
      to.report += file_ + ":" + std::to_string(given.line) + ": " + name_ + "." + given.key + ": " + value +
                   ": " + fate + "\n";
    }
    to.yaml += yaml();
  }

 private:
  void flatten(const YAML::Node& map, const std::string& prefix) {
    for (const auto& entry : map) {
      const int line = entry.first.Mark().line + 1;
      if (!entry.first.IsScalar()) throw IoError(file_, line, "a key in " + name_ + " must be a name");
      const Given given{prefix + entry.first.Scalar(), line, entry.second};
      if (find(given.key)) refuse(given, "duplicate key");
      if (entry.second.IsMap())
        flatten(entry.second, given.key + ".");
      else
        given_.push_back(given);
    }
  }

  [[noreturn]] void refuse(const Given& given, const std::string& rule) const {
    throw IoError(file_, given.line, "key " + name_ + "." + given.key + ": " + rule);
  }
  const Given* find(const std::string& key) const {
    const auto found =
        std::find_if(given_.begin(), given_.end(), [&](const Given& each) { return each.key == key; });
    return found == given_.end() ? nullptr : &*found;
  }
  std::string text_of(const Given& given) const {
    if (!given.value.IsScalar()) refuse(given, "must be one value");
    const std::string& text = given.value.Scalar();
    // YAML allows these; options are written in small letters.
    if (text == "True" || text == "TRUE") return "true";
    if (text == "False" || text == "FALSE") return "false";
    return text;
  }
  double number_of(const Given& given) const {
    const std::string text = text_of(given);
    const std::optional<double> number = maps::finite_number(text);
    if (!number) refuse(given, "'" + text + "' must be a number");
    return *number;
  }

  bool is_option(const std::string& name) const {
    const std::vector<NamedOption> options = settings_.list();
    return std::ranges::find(options, name, &NamedOption::name) != options.end();
  }
  /// The fate of a key that is not taken.
  std::string fate_of(const std::string& key) const {
    std::vector<std::string> names{"plugin"};
    for (const NamedOption& each : settings_.list()) names.push_back(each.name);
    for (const Dropped& each : dropped) {
      std::string name = each.key;
      const bool is_section = name.back() == '.';
      if (is_section ? key.starts_with(name) : key == name) return std::string("dropped (") + each.why + ")";
      if (is_section) name.pop_back();
      names.push_back(std::move(name));
    }
    const std::string nearest = nearest_name(key, names);
    return "unknown (no parameter of nav2's MPPI controller" +
           (nearest.empty() ? "" : ", did you mean '" + nearest + "'?") + ")";
  }

  /// Sets an option to a text that follows from a key. Returns the fate of the key.
  std::string take(const Given& given, const std::string& option, const std::string& text,
                   const std::string& why) {
    try {
      settings_.set(option, text);
    } catch (const std::invalid_argument& error) {
      const std::string what = error.what(), with_name = option + ": ";
      refuse(given, what.starts_with(with_name) ? what.substr(with_name.size()) : what);
    }
    set_.insert(option);
    if (option == given.key && text == text_of(given)) return "taken";
    return "changed to " + option + ": " + text + " (" + why + ")";
  }

  /// The value of `motion_model`; in nav2 1.5 it names a section with the plugin.
  std::string model_key() const {
    const Given* const given = find("motion_model");
    return given ? text_of(*given) : "diff_drive";
  }
  /// The motion model by its name here: that of a plugin is "mppi::", this name and "MotionModel".
  std::string model() const {
    const std::string key = model_key();
    const Given* const plugin = find(key + ".plugin");
    if (!plugin) return key == "diff_drive" ? "DiffDrive" : key;
    const std::string name = text_of(*plugin), end = "MotionModel";
    if (name.starts_with("mppi::") && name.ends_with(end))
      return name.substr(6, name.size() - 6 - end.size());
    refuse(*plugin, "'" + name + "' must be a motion model of mppi");
  }
  bool no_turn_sampled() const {
    const Given* const given = find("wz_std");
    return given && number_of(*given) == 0;
  }

  /// Takes the dead bands of the speeds forward, to the left and turning.
  std::string take_dead_bands(const Given& given) {
    constexpr std::array names{"dead_band_forward", "dead_band_sideways", "dead_band_turn"};
    if (!given.value.IsSequence() || given.value.size() != names.size())
      refuse(given, "must be a list of 3 numbers");
    for (std::size_t i = 0; i < names.size(); ++i)
      take({given.key, given.line, given.value[i]}, names[i], given.value[i].Scalar(), "");
    return "changed to dead_band_forward, dead_band_sideways and dead_band_turn";
  }

  /// The temperature here. Costs have another scale, so the ratio to the default is kept.
  std::string temperature(const Given& given) const {
    const double number = number_of(given);
    if (number < 0) refuse(given, "'" + text_of(given) + "' must be at least 0");
    constexpr double usual = 0.3, least = 1e-6;
    const SolverOptions solver = settings_.solver(1);
    std::ostringstream text;
    text.precision(10);  // a product of decimal numbers should read as one
    text << std::max(*solver.find<double>("temperature") * number / usual, least);
    return text.str();
  }

  std::string yaml() const {
    std::ostringstream yaml;
    yaml << "# From " << file_ << ":" << line_ << ". What is not here has Slalom's default.\n"
         << name_ << ":\n  plugin: \"slalom_nav2::Controller\"\n";
    std::map<std::string, std::string> nested;  // by section
    for (const auto& [name, entry] : settings_.list()) {
      if (set_.count(name) == 0) continue;
      std::string value = to_text(entry.value);
      // ROS takes no integer for a number.
      if (std::holds_alternative<double>(entry.value) && value.find_first_of(".ein") == std::string::npos)
        value += ".0";
      const auto dot = name.find('.');
      if (dot == std::string::npos)
        yaml << "  " << name << ": " << value << "\n";
      else
        nested[name.substr(0, dot)] += "    " + name.substr(dot + 1) + ": " + value + "\n";
    }
    for (const auto& [section, lines] : nested) yaml << "  " << section << ":\n" << lines;
    return yaml.str();
  }

  std::string file_, name_;
  int line_;
  std::vector<Given> given_;  ///< in the order of the file
  FollowerSettings settings_{"svg_mppi"};
  std::set<std::string> set_;  ///< options that are set
};

void import_sections(const std::string& file, const YAML::Node& map, MppiImport& to) {
  if (!map.IsMap()) return;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar() || !entry.second.IsMap()) continue;
    const YAML::Node plugin = entry.second["plugin"];
    if (plugin && plugin.IsScalar() && plugin.Scalar() == mppi)
      Section(file, entry.first.Scalar(), entry.first.Mark().line + 1, entry.second).import(to);
    else
      import_sections(file, entry.second, to);
  }
}

}  // namespace

MppiImport import_mppi(const std::string& file) {
  MppiImport imported;
  import_sections(file, YAML::Load(maps::yaml_text(file)), imported);
  if (imported.yaml.empty())
    throw IoError(file, 0, std::string("must have a section with plugin: \"") + mppi + "\"");
  return imported;
}

}  // namespace slalom::nodes
