// The experiments of an evaluation, from --methods, --scenario and --set.
#include <set>

#include "tools/evaluation/evaluation_job.hpp"

namespace slalom::tools {
namespace {

using evaluation::Experiment;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += (c == '[') - (c == ']');
    if (c == at && depth == 0) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

struct Sweep {
  std::string key;
  std::vector<std::string> values;
};

Sweep parse_sweep(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw CommandLineError("--set", text, "must be key=value or key=v1,v2,...");
  Sweep sweep{text.substr(0, equals), split(text.substr(equals + 1), ',')};
  for (const auto& value : sweep.values) {
    if (value.empty()) throw CommandLineError("--set", text, "must have a value behind each comma");
  }
  return sweep;
}

/// Whether an option affects laps of a method: an option of the method, vehicle, planner or world.
bool applies_to(const std::string& key, const std::string& method) {
  const auto dot = key.find('.');
  if (dot == std::string::npos) return true;
  const std::string section = key.substr(0, dot);
  return section == method || section == "vehicle" || section == "planner" || section == "world";
}

/// Throws CommandLineError if an option affects none of the methods.
void require_driven(const std::string& key, const std::vector<std::string>& methods) {
  std::string names;
  for (const std::string& method : methods) {
    if (applies_to(key, method)) return;
    names += (names.empty() ? "" : ", ") + method;
  }
  throw CommandLineError("--set", key, "must be an option of a method in this evaluation (" + names + ")");
}

/// Throws CommandLineError if both keys are the same option of one of the methods.
void refuse_twice(const std::string& key, const std::string& other, const std::vector<std::string>& methods) {
  const auto full = [](const std::string& name, const std::string& method) {
    return name.find('.') == std::string::npos ? method + "." + name : name;
  };
  for (const std::string& method : methods)
    if (full(key, method) == full(other, method))
      throw CommandLineError("--set", key,
                             "is given twice; separate several values by commas: " + key + "=v1,v2,...");
}

/// Parses the sweeps. Each must affect one of the methods, and no two the same option.
std::vector<Sweep> parse_sweeps(const std::vector<std::string>& texts,
                                const std::vector<std::string>& methods) {
  std::vector<Sweep> sweeps;
  for (const std::string& text : texts) {
    Sweep sweep = parse_sweep(text);
    require_driven(sweep.key, methods);
    for (const Sweep& other : sweeps) refuse_twice(sweep.key, other.key, methods);
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

}  // namespace

std::vector<Experiment> make_experiments(const std::vector<std::string>& methods,
                                         const std::vector<std::string>& scenarios, int laps, int obstacles,
                                         const std::vector<std::string>& texts) {
  std::vector<Experiment> experiments;
  for (const std::string& method : methods) for_option("--methods", [&] { return solver_options(method); });
  const std::vector<Sweep> sweeps = parse_sweeps(texts, methods);
  for (const std::string& scenario : scenarios) {
    if (scenario != "pt" && scenario != "oa")
      throw CommandLineError("--scenario", scenario, "must be pt or oa");
    for (const std::string& method : methods) {
      std::vector<Experiment> variants{{method, {}, scenario, scenario == "pt" ? 0 : obstacles, laps}};
      for (const Sweep& sweep : sweeps) {
        if (!applies_to(sweep.key, method)) continue;
        std::vector<Experiment> next;
        for (const Experiment& variant : variants) {
          for (const std::string& value : sweep.values) {
            next.push_back(variant);
            next.back().set.emplace_back(sweep.key, value);
          }
        }
        variants = std::move(next);
      }
      experiments.insert(experiments.end(), variants.begin(), variants.end());
    }
  }
  // Two equal experiments could not be distinguished in laps.csv.
  std::set<std::string> seen;
  for (const Experiment& e : experiments)
    if (!seen.insert(e.label() + ", " + e.scenario).second)
      throw CommandLineError("--methods, --scenario, --set",
                             "specify the experiment '" + e.label() + ", " + e.scenario + "' twice");
  return experiments;
}

}  // namespace slalom::tools
