#include "logic/mppi_import.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "logic/follower_settings.hpp"
#include "logic/mppi_keys.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/maps/yaml_text.hpp"

namespace slalom::nodes {
namespace {

using Fate = ImportedKey::Fate;

constexpr const char* mppi = "nav2_mppi_controller::MPPIController";

/// A key of a section, and its value in the file.
struct Given {
  std::string key;
  int line;
  YAML::Node value;
};

/// The import of one section.
class Import {
 public:
  Import(std::string file, std::string section, int line, const YAML::Node& node) : file_(std::move(file)) {
    result_.name = std::move(section);
    result_.line = line;
    flatten(node, "");
  }

  ImportedSection run() {
    take_accelerations();
    for (const Given& given : given_) {
      if (done_.count(given.key) > 0) continue;
      if (given.key == "plugin") {
        report(given, Fate::changed, "plugin: slalom_nav2::Controller", "");
      } else if (given.key == "temperature") {
        take_temperature(given);
      } else if (given.key == "GoalAngleCritic.threshold_to_consider") {
        take(given, "costs.goal_reach", text_of(given));
      } else if (mppi_keys::is_taken(given.key)) {
        take(given, given.key, text_of(given));
      } else if (const char* const why = mppi_keys::why_dropped(given.key)) {
        report(given, Fate::dropped, "", why);
      } else {
        report_unknown(given);
      }
    }
    std::stable_sort(result_.keys.begin(), result_.keys.end(),
                     [](const ImportedKey& a, const ImportedKey& b) { return a.line < b.line; });
    write_yaml();
    return result_;
  }

 private:
  void flatten(const YAML::Node& map, const std::string& prefix) {
    for (const auto& entry : map) {
      const int line = entry.first.Mark().line + 1;
      if (!entry.first.IsScalar()) throw IoError(file_, line, "a key in " + result_.name + " must be a name");
      const std::string key = prefix + entry.first.Scalar();
      if (std::any_of(given_.begin(), given_.end(), [&](const Given& each) { return each.key == key; }))
        refuse(line, key, "duplicate key");
      if (entry.second.IsMap()) {
        flatten(entry.second, key + ".");
      } else {
        given_.push_back({key, line, entry.second});
      }
    }
  }

  [[noreturn]] void refuse(int line, const std::string& key, const std::string& rule) const {
    throw IoError(file_, line, "key " + result_.name + "." + key + ": " + rule);
  }

  const Given* find(const std::string& key) const {
    const auto found =
        std::find_if(given_.begin(), given_.end(), [&](const Given& each) { return each.key == key; });
    return found == given_.end() ? nullptr : &*found;
  }
  std::string text_of(const Given& given) const {
    if (!given.value.IsScalar()) refuse(given.line, given.key, "must be one value");
    const std::string& text = given.value.Scalar();
    // YAML allows these; options are written in small letters.
    if (text == "True" || text == "TRUE") return "true";
    if (text == "False" || text == "FALSE") return "false";
    return text;
  }
  double number_of(const Given& given) const {
    const std::string text = text_of(given);
    const std::optional<double> number = maps::finite_number(text);
    if (!number) refuse(given.line, given.key, "'" + text + "' must be a number");
    return *number;
  }

  void report(const Given& given, Fate fate, const std::string& result, const std::string& why) {
    const YAML::Node& value = given.value;
    result_.keys.push_back({given.line, given.key,
                            value.IsScalar()     ? value.Scalar()
                            : value.IsSequence() ? "a list"
                                                 : "nothing",
                            fate, result, why});
  }
  void report_unknown(const Given& given) {
    const std::string nearest = nearest_name(given.key, mppi_keys::all());
    report(given, Fate::unknown, "",
           "no parameter of nav2's MPPI controller" +
               (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
  }

  /// Sets an option from a key, to its text or to another text that follows from it.
  void take(const Given& given, const std::string& option, const std::string& text,
            const std::string& why = "") {
    try {
      settings_.set(option, text);
    } catch (const std::invalid_argument& error) {
      const std::string what = error.what();
      const std::string with_name = option + ": ";
      refuse(given.line, given.key, what.rfind(with_name, 0) == 0 ? what.substr(with_name.size()) : what);
    }
    taken_.push_back(option);
    const bool same = option == given.key && text == text_of(given);
    report(given, same ? Fate::taken : Fate::changed, same ? "" : option + ": " + text,
           same          ? ""
           : why.empty() ? "the name here"
                         : why);
    done_.insert(given.key);
  }

  /// Sets the limit of the acceleration. One limit holds in all directions, so the least one is taken.
  void take_accelerations() {
    std::vector<const char*> keys{"ax_max", "ax_min"};
    if (const Given* const model = find("motion_model"); model && text_of(*model) == "Omni")
      keys.insert(keys.end(), {"ay_max", "ay_min"});
    const Given* least = nullptr;
    for (const char* key : keys)
      if (const Given* const given = find(key))
        if (!least || std::abs(number_of(*given)) < std::abs(number_of(*least))) least = given;
    if (!least) return;
    const char* const why = "one limit holds in all directions, the least";
    const bool as_given = least->key == "ax_max";
    take(*least, "ax_max", as_given ? text_of(*least) : to_text(std::abs(number_of(*least))), why);
  }

  /// Sets the temperature. Costs have another scale here, so the ratio to the default is kept.
  void take_temperature(const Given& given) {
    const double number = number_of(given);
    if (number < 0) refuse(given.line, given.key, "'" + text_of(given) + "' must be at least 0");
    constexpr double usual = 0.3, least = 1e-6;
    const SolverOptions solver = settings_.solver(1);
    const double* const here = solver.find<double>("temperature");
    // Ten digits: a product of decimal numbers should read as one.
    std::ostringstream text;
    text.precision(10);
    text << std::max((here ? *here : usual) * number / usual, least);
    take(given, "temperature", text.str(), "costs have another scale; its ratio to the default is kept");
  }

  void write_yaml() {
    std::ostringstream yaml;
    yaml << "# From " << file_ << ":" << result_.line << ". What is not here has Slalom's default.\n"
         << result_.name << ":\n  plugin: \"slalom_nav2::Controller\"\n";
    std::map<std::string, std::string> nested;  // by section
    for (const auto& [name, entry] : settings_.list()) {
      if (std::find(taken_.begin(), taken_.end(), name) == taken_.end()) continue;
      std::string value = to_text(entry.value);
      // ROS takes no integer for a number.
      if (std::holds_alternative<double>(entry.value) && value.find_first_of(".ein") == std::string::npos)
        value += ".0";
      const auto dot = name.find('.');
      if (dot == std::string::npos) {
        yaml << "  " << name << ": " << value << "\n";
      } else {
        nested[name.substr(0, dot)] += "    " + name.substr(dot + 1) + ": " + value + "\n";
      }
    }
    for (const auto& [section, lines] : nested) yaml << "  " << section << ":\n" << lines;
    result_.yaml = yaml.str();
  }

  std::string file_;
  ImportedSection result_;
  std::vector<Given> given_;
  FollowerSettings settings_{"svg_mppi"};
  std::vector<std::string> taken_;  ///< options that are set
  std::set<std::string> done_;      ///< keys that are reported
};

void find_sections(const std::string& file, const YAML::Node& map, std::vector<ImportedSection>& found) {
  if (!map.IsMap()) return;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar() || !entry.second.IsMap()) continue;
    const YAML::Node plugin = entry.second["plugin"];
    if (plugin && plugin.IsScalar() && plugin.Scalar() == mppi) {
      found.push_back(Import(file, entry.first.Scalar(), entry.first.Mark().line + 1, entry.second).run());
    } else {
      find_sections(file, entry.second, found);
    }
  }
}

}  // namespace

const char* name(ImportedKey::Fate fate) {
  switch (fate) {
    case Fate::taken:
      return "taken";
    case Fate::changed:
      return "changed";
    case Fate::dropped:
      return "dropped";
    case Fate::unknown:
      break;
  }
  return "unknown";
}

std::vector<ImportedSection> import_mppi(const std::string& file) {
  std::vector<ImportedSection> sections;
  find_sections(file, YAML::Load(maps::yaml_text(file)), sections);
  if (sections.empty())
    throw IoError(file, 0, std::string("must have a section with plugin: \"") + mppi + "\"");
  return sections;
}

}  // namespace slalom::nodes
