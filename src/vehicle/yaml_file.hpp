#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>

namespace slalom::vehicle::detail {

/// The one document of a file. Throws IoError if it cannot be read, is not YAML as
/// maps::yaml_text takes it, or has a duplicate key.
YAML::Node load_yaml(const std::filesystem::path& file);

/// Throws the IoError which says that the value `at` of `key` breaks `rule`.
[[noreturn]] void throw_at(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
                           const std::string& rule);

}  // namespace slalom::vehicle::detail
