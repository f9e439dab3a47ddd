#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace slalom::maps {

/// The largest YAML file that is read.
struct YamlLimits {
  static constexpr std::uint64_t bytes = 1 << 20;  ///< size of the file
  static constexpr int depth = 32;                 ///< depth of nested maps and lists
};

/// A YAML file of one document, which can be parsed in bounded time and memory. Throws IoError if the file
/// cannot be read, exceeds YamlLimits, is not YAML, or holds more than one document, an anchor or an alias.
std::string yaml_text(const std::filesystem::path& file);

/// The finite number that a text is, in decimal; nothing for any other text. Allocates nothing, unlike the
/// conversions of yaml-cpp, which take a number for none where memory has run out.
std::optional<double> finite_number(std::string_view text) noexcept;

}  // namespace slalom::maps
