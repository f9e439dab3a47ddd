#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>

namespace slalom::maps::detail {

/// What a YAML file may be, at most.
struct YamlLimits {
  static constexpr std::uint64_t bytes = 1 << 20;  ///< of the file
  static constexpr int depth = 32;                 ///< of nested maps and lists
};

/// The one document of a file. Throws IoError if it cannot be read, exceeds YamlLimits, is not YAML, holds
/// more than one document, an anchor or an alias, or has a duplicate key.
YAML::Node load_yaml(const std::filesystem::path& file);

/// Throws the IoError which says that the value `at` of `key` breaks `rule`.
[[noreturn]] void throw_at(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
                           const std::string& rule);

}  // namespace slalom::maps::detail
