#include "vehicle/yaml_file.hpp"

#include <set>

#include "slalom/core/error.hpp"
#include "slalom/maps/yaml_text.hpp"

namespace slalom::vehicle::detail {
namespace {

/// yaml-cpp accepts duplicate keys and keeps one of them.
void check_repeated_keys(const std::filesystem::path& file, const YAML::Node& map,
                         const std::string& prefix) {
  if (!map.IsMap()) return;
  std::set<std::string> seen;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) continue;
    const std::string key = prefix + entry.first.Scalar();
    if (!seen.insert(key).second)
      throw IoError(file.string(), entry.first.Mark().line + 1, "key " + key + ": duplicate key");
    check_repeated_keys(file, entry.second, key + ".");
  }
}

}  // namespace

YAML::Node load_yaml(const std::filesystem::path& file) {
  const YAML::Node document = YAML::Load(maps::yaml_text(file));
  check_repeated_keys(file, document, "");
  return document;
}

void throw_at(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
              const std::string& rule) {
  const std::string value = at.IsScalar() && !at.Scalar().empty() ? "'" + at.Scalar() + "' " : "";
  throw IoError(file.string(), at.Mark().line + 1, "key " + key + ": " + value + rule);
}

}  // namespace slalom::vehicle::detail
