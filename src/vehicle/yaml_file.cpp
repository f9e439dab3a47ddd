#include "vehicle/yaml_file.hpp"

#include <fstream>
#include <set>
#include <vector>

#include "slalom/core/error.hpp"

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

/// yaml-cpp does not mention that a tab must not indent.
std::string tab_hint(const std::filesystem::path& file, int line) {
  std::ifstream stream(file);
  std::string text;
  for (int number = 0; number < line && std::getline(stream, text);) ++number;
  const bool indents = text.substr(0, text.find_first_not_of(" \t")).find('\t') != std::string::npos;
  return indents ? "; the line begins with a tab, but YAML must be indented with spaces" : "";
}

}  // namespace

YAML::Node load_yaml(const std::filesystem::path& file) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAllFromFile(file.string());
  } catch (const YAML::BadFile&) {
    throw IoError(file.string(), 0, "cannot be opened");
  } catch (const YAML::Exception& error) {
    const int line = error.mark.line + 1;
    throw IoError(file.string(), line, "is not YAML: " + error.msg + tab_hint(file, line));
  }
  if (documents.empty()) return {};
  if (documents.size() > 1)
    throw IoError(file.string(), documents[1].Mark().line + 1,
                  "must have only one YAML document, this is a second one");
  check_repeated_keys(file, documents[0], "");
  return documents[0];
}

void throw_at(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
              const std::string& rule) {
  const std::string value = at.IsScalar() && !at.Scalar().empty() ? "'" + at.Scalar() + "' " : "";
  throw IoError(file.string(), at.Mark().line + 1, "key " + key + ": " + value + rule);
}

}  // namespace slalom::vehicle::detail
