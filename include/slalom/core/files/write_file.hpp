#pragma once

#include <filesystem>
#include <string_view>

#include "slalom/core/error.hpp"

namespace slalom {

/// Writes a whole file. If that fails, throws IoError with the system's reason, and leaves no part of it.
void write_file(const std::filesystem::path& file, std::string_view bytes);

/// The error of a file that could not be written, with the system's reason: the `errno` of the failed call.
IoError cannot_write(const std::filesystem::path& file);

}  // namespace slalom
