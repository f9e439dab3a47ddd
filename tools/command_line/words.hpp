#pragma once

#include <cstdio>
#include <string>

/// Words of the commands: numbers, and parts of command lines that are written into files.
namespace slalom::tools {

/// A text in printf's format.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// Columns of the terminal behind a stream; 80 if there is none.
int terminal_columns(std::FILE* stream);

/// A number as short as six digits allow.
std::string short_number(double value);

/// A word as a shell reads it back.
std::string shell_word(const std::string& text);

/// A folder's own name, also where the path ends in a slash or is ".".
std::string folder_name(const std::string& folder);

}  // namespace slalom::tools
