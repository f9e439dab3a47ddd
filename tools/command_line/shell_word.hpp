#pragma once

#include <string>

/// Parts of the commands that are written into files.
namespace slalom::tools {

/// A number as short as six digits allow.
std::string short_number(double value);

/// A word as a shell reads it back.
std::string shell_word(const std::string& text);

/// A folder's own name, also where the path ends in a slash or is ".".
std::string folder_name(const std::string& folder);

}  // namespace slalom::tools
