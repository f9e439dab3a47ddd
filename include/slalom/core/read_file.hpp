#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "slalom/core/error.hpp"

namespace slalom {

/// The bytes of a regular file of at most `most` bytes. Throws IoError if the file does not exist or cannot
/// be read, is not a regular file (a pipe could block for ever), or is larger.
std::string read_file(const std::filesystem::path& file, std::uint64_t most);

/// The error of a file or folder that is there, but that the system did not open. It states the reason, such
/// as too many open files: the `errno` of the failed call.
IoError cannot_open(const std::filesystem::path& file);

/// Returns the entries of a folder, sorted. Throws IoError if it cannot be listed. Unlike the iterators of
/// the standard library it can run out of memory without ending the program.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);

}  // namespace slalom
