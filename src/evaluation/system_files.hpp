#pragma once

#include <filesystem>
#include <string>

namespace slalom::evaluation::detail {

/// Throws the IoError that names `file`, `what` and the meaning of errno.
[[noreturn]] void throw_system(const std::filesystem::path& file, const char* what);

/// Writes a whole text to the open `file`. Throws IoError if the system does not take all of it.
void write_all(int descriptor, const std::string& text, const std::filesystem::path& file);

}  // namespace slalom::evaluation::detail
