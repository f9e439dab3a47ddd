#include <map>
#include <set>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "vehicle/yaml_file.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr int deepest_base = 8;

using Lines = std::map<std::string, int>;  ///< line of each key that a file sets

int line_of(const YAML::Node& node) {
  return node.Mark().line + 1;
}

/// An option's value as text: a scalar, or a list of scalars as "[a, b]".
std::string text_of(const fs::path& file, const std::string& key, const YAML::Node& value) {
  if (value.IsScalar()) return value.Scalar();
  if (!value.IsSequence()) detail::throw_at(file, value, key, "must have a value, or a list of values");
  std::string text;
  for (const YAML::Node& each : value) {
    if (!each.IsScalar()) detail::throw_at(file, each, key, "must be a list of plain values");
    text += (text.empty() ? "[" : ", ") + each.Scalar();
  }
  return text.empty() ? "[]" : text + "]";
}

bool is_choice(const Configuration& configuration, const std::string& key) {
  for (const Section& section : list_sections(configuration))
    for (const OptionEntry& entry : section.options)
      if (section.name + "." + entry.declaration.name == key) return !entry.choices.empty();
  return true;
}

void read_option(Configuration& configuration, const fs::path& file, const std::string& key,
                 const YAML::Node& at, const YAML::Node& value) {
  // yaml-cpp gives an absent value the position of the next token.
  if (value.IsNull()) throw IoError(file.string(), line_of(at), "key " + key + ": must have a value");
  const std::string text = text_of(file, key, value);
  if (value.IsScalar() && value.Tag() == "!" && !is_choice(configuration, key))
    detail::throw_at(file, value, key, "must not be quoted");
  try {
    set_option(configuration, key, text);
  } catch (const std::invalid_argument& error) {
    throw IoError(file.string(), line_of(at), error.what());
  }
}

void read_section(Configuration& configuration, const fs::path& file, const std::string& section,
                  const YAML::Node& options, Lines& lines) {
  if (options.IsNull()) return;
  if (!options.IsMap()) detail::throw_at(file, options, section, "must be a map of options to values");
  for (const auto& entry : options) {
    if (!entry.first.IsScalar())
      detail::throw_at(file, entry.first, section, "must have plain words as keys");
    const std::string key = section + "." + entry.first.Scalar();
    read_option(configuration, file, key, entry.first, entry.second);
    lines[key] = line_of(entry.first);
  }
}

void check_section(const Configuration& configuration, const fs::path& file, const YAML::Node& name) {
  std::vector<std::string> names = {"base"};
  visit_sections(configuration, [&](const char* section, const auto&) { names.emplace_back(section); });
  if (std::find(names.begin(), names.end(), name.Scalar()) != names.end()) return;
  const std::string near = nearest_name(name.Scalar(), names);
  throw IoError(file.string(), line_of(name),
                "key " + name.Scalar() + ": unknown section; must be one of " + detail::listed(names, "") +
                    (near.empty() ? "" : "; did you mean " + near + "?"));
}

/// Rules between the keys of a file, in whatever order they are.
void check_together(const Configuration& configuration, const fs::path& file, Lines& lines) {
  const int inputs = input_count(configuration.vehicle);
  for (const Section& section : list_sections(configuration)) {
    for (const OptionEntry& entry : section.options) {
      const auto* values = std::get_if<std::vector<double>>(&entry.value);
      if (!values || entry.declaration.any_count || static_cast<int>(values->size()) <= inputs) continue;
      // Only possible where the base has a model of more inputs.
      throw IoError(file.string(), lines["vehicle.model"],
                    "key vehicle.model: the model has only the input " + input_names(configuration.vehicle) +
                        ", but " + section.name + "." + entry.declaration.name + " has " +
                        std::to_string(values->size()) + " values in the base");
    }
  }
  for (const SolverOptions& method : configuration.methods) {
    const PerInput& low = *method.find<PerInput>("input_min");
    const PerInput& high = *method.find<PerInput>("input_max");
    for (int i = 0; i < inputs; ++i) {
      if (low[i] <= high[i]) continue;
      const std::string section = std::string(method.method()) + ".";
      throw IoError(file.string(), std::max(lines[section + "input_min"], lines[section + "input_max"]),
                    "key " + section + "input_min: '" + to_text(low[i]) + "' must be at most " + section +
                        "input_max, '" + to_text(high[i]) + "'");
    }
  }
}

/// The file that `base` names: one beside the file, or a configuration known by name.
fs::path find_base(const fs::path& file, const YAML::Node& base, const std::vector<fs::path>& roots) {
  const fs::path beside = file.parent_path() / base.Scalar();
  if (fs::is_regular_file(beside)) return beside;
  auto places = roots;
  places.insert(places.begin(), file.parent_path());
  try {
    return find_configuration(base.Scalar(), places);
  } catch (const IoError& error) {
    const std::string what = error.what();
    throw IoError(file.string(), line_of(base),
                  "key base: '" + base.Scalar() + "' " + what.substr(error.file().size() + 2));
  }
}

Configuration load_deep(const fs::path& file, const std::vector<fs::path>& roots, int depth) {
  const YAML::Node root = detail::load_yaml(file);
  Configuration configuration;
  if (root.IsNull()) return configuration;
  if (!root.IsMap()) throw IoError(file.string(), line_of(root), "must be a map of sections");
  if (const YAML::Node base = root["base"]) {
    if (!base.IsScalar()) detail::throw_at(file, base, "base", "must be the name or file of a configuration");
    if (depth == deepest_base)
      detail::throw_at(file, base, "base", "must not form a cycle or a chain of more than 8 files");
    configuration = load_deep(find_base(file, base, roots), roots, depth + 1);
  }
  Lines lines;
  // The vehicle comes first, since its number of inputs decides which values are valid for the methods.
  for (const bool vehicles : {true, false}) {
    for (const auto& entry : root) {
      const bool plain = entry.first.IsScalar();
      if ((plain && entry.first.Scalar() == "vehicle") != vehicles) continue;
      if (!plain)
        throw IoError(file.string(), line_of(entry.first), "the name of a section must be a plain word");
      if (entry.first.Scalar() == "base") continue;
      check_section(configuration, file, entry.first);
      read_section(configuration, file, entry.first.Scalar(), entry.second, lines);
    }
  }
  check_together(configuration, file, lines);
  return configuration;
}

}  // namespace

Configuration load_configuration(const fs::path& file, const std::vector<fs::path>& roots) {
  return load_deep(file, roots, 0);
}

std::vector<fs::path> configuration_roots(const fs::path& program_folder) {
  return detail::known_folders(program_folder, "configs", "published.yaml", "SLALOM_CONFIGS_DIR");
}

fs::path find_configuration(const std::string& name_or_file, const std::vector<fs::path>& roots) {
  if (name_or_file.empty())
    throw IoError("config", 0, "is empty; must be a file or the name of a configuration");
  if (fs::is_regular_file(name_or_file)) return name_or_file;
  std::set<std::string> known;
  for (const auto& root : roots) {
    if (const fs::path file = root / (name_or_file + ".yaml"); fs::is_regular_file(file)) return file;
    if (!fs::is_directory(root)) continue;
    for (const fs::path& entry : list_folder(root))
      if (entry.extension() == ".yaml") known.insert(entry.stem().string());
  }
  throw IoError(name_or_file, 0,
                "is neither a file nor the name of a configuration (known: " +
                    detail::listed({known.begin(), known.end()}, "none") +
                    "; searched: " + detail::listed(roots) + ")");
}

}  // namespace slalom::vehicle
