#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace slalom {

/// The bytes of a regular file of at most `most` bytes. Throws IoError if the file does not exist or cannot
/// be read, is not a regular file (a pipe could block for ever), or is larger.
std::string read_file(const std::filesystem::path& file, std::uint64_t most);

}  // namespace slalom
