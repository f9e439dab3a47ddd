#pragma once

#include <string>
#include <string_view>

namespace slalom::view {

/// Encodes bytes as text, with padding.
std::string base64(std::string_view bytes);
/// Compresses bytes. The result depends on them alone: it contains no time and no name.
std::string gzip(std::string_view bytes);
/// Decompresses bytes. Throws std::invalid_argument if they are not gzip, damaged or incomplete.
std::string gunzip(std::string_view bytes);
/// Compresses bytes quickly, for `unpack`. Throws std::runtime_error if memory runs out.
std::string pack(std::string_view bytes);
/// Returns the bytes that `pack` has compressed.
std::string unpack(std::string_view packed);

}  // namespace slalom::view
