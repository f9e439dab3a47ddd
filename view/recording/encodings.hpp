#pragma once

#include <string>
#include <string_view>

namespace slalom::view {

std::string base64(std::string_view bytes);
/// Depends on the bytes alone: no time, no name.
std::string gzip(std::string_view bytes);
/// Throws std::invalid_argument on what gzip did not make.
std::string gunzip(std::string_view bytes);

}  // namespace slalom::view
