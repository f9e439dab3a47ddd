#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slalom::view::mcap {

/// A file inside an MCAP file.
struct Attachment {
  std::string name, data;
};

/// Returns the attachments of an MCAP file whose names begin with `prefix`, in the order of the file,
/// checksums checked. Of a file that was cut: those that are whole, and `lost` receives the number of bytes
/// after its last whole record. Throws IoError if a file is not MCAP, damaged, or cut without `lost`.
std::vector<Attachment> read_attachments(const std::string& file, std::string_view prefix,
                                         std::uint64_t* lost = nullptr);

}  // namespace slalom::view::mcap
