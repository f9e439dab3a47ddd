#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::vehicle {
namespace {

[[noreturn]] void throw_unknown_key(const Configuration& configuration, std::string_view key) {
  std::string sections;
  std::vector<std::string> keys;
  bool section_known = false;
  const std::string_view section = key.substr(0, key.find('.'));
  for (const Section& each : list_sections(configuration)) {
    sections += (sections.empty() ? "" : ", ") + each.name;
    section_known = section_known || each.name == section;
    for (const OptionEntry& entry : each.options) keys.push_back(each.name + "." + entry.declaration.name);
  }
  std::string message = "key " + std::string(key) + ": unknown option";
  if (section_known)
    message += " of section " + std::string(section);
  else
    message += "; must be section.option, where section is one of " + sections;
  if (const std::string near = nearest_name(key, keys); !near.empty())
    message += "; did you mean " + near + "?";
  throw std::invalid_argument(message);
}

/// A list of the wrong length would only be found when a solver is made, far from the line that sets it.
template <class Options>
void check_count(const Options& options, std::string_view name, std::string_view text,
                 const VehicleOptions& vehicle) {
  const int inputs = input_count(vehicle);
  for (const OptionEntry& entry : list_options(options)) {
    const auto* values = std::get_if<std::vector<double>>(&entry.value);
    if (name != entry.declaration.name || !values || entry.declaration.any_count) continue;
    if (values->size() == 1 || static_cast<int>(values->size()) == inputs) continue;
    throw std::invalid_argument(
        "'" + std::string(text) + "' has " + std::to_string(values->size()) + " values, must have 1" +
        (inputs > 1 ? " or " + std::to_string(inputs) : std::string()) + ": the input" +
        (inputs > 1 ? "s" : "") + " of vehicle.model '" +
        enum_names(vehicle.model)[static_cast<int>(vehicle.model)] + "': " + input_names(vehicle));
  }
}

}  // namespace

std::vector<SolverOptions> Configuration::every_method() {
  std::vector<SolverOptions> methods;
  for (const char* method : solver_names()) methods.push_back(solver_options(method));
  return methods;
}

std::unique_ptr<Solver> make_solver(const Configuration& configuration, std::string_view method,
                                    int threads) {
  SolverOptions chosen = solver_options(method);
  for (const SolverOptions& each : configuration.methods)
    if (method == solver_name(each)) chosen = each;
  *chosen.find<int>("threads") = threads;
  try {
    return slalom::make_solver(chosen, input_count(configuration.vehicle));
  } catch (const std::invalid_argument& error) {
    const std::string section = std::string(method) + ".", message = error.what();
    if (message.rfind(section, 0) == 0) throw;
    throw std::invalid_argument(section + message);  // a rule between options has no section
  }
}

void set_option(Configuration& configuration, std::string_view key, std::string_view text,
                std::string_view default_section) {
  std::string full(key);
  if (full.find('.') == std::string::npos && !default_section.empty())
    full = std::string(default_section) + "." + full;
  const auto dot = full.find('.');
  bool found = false;
  try {
    visit_sections(configuration, [&](std::string_view section, auto& options) {
      if (dot == std::string::npos || section != std::string_view(full).substr(0, dot)) return;
      const std::string_view name = std::string_view(full).substr(dot + 1);
      auto changed = options;
      found = slalom::set_option(changed, name, text);
      check_count(changed, name, text, configuration.vehicle);
      options = std::move(changed);
    });
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("key " + std::string(key) + ": " + error.what());
  }
  if (!found) throw_unknown_key(configuration, full);
}

std::vector<Section> list_sections(const Configuration& configuration) {
  std::vector<Section> sections;
  visit_sections(configuration, [&](const char* name, const auto& options) {
    sections.push_back({name, list_options(options)});
  });
  return sections;
}

std::string to_yaml(const Configuration& configuration) {
  std::string text;
  for (const Section& section : list_sections(configuration)) {
    text += section.name + ":\n";
    for (const OptionEntry& entry : section.options)
      text += std::string("  ") + entry.declaration.name + ": " + to_text(entry.value) + "\n";
  }
  return text;
}

}  // namespace slalom::vehicle
