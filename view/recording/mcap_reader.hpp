#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slalom::view::mcap {

struct Attachment {
  std::string name, media_type, data;
};

/// The attachments of an MCAP file whose names begin with `prefix`, in the order of the file; found by the
/// index at its end, checksums checked. Throws IoError if a file is not MCAP, incomplete or damaged.
std::vector<Attachment> read_attachments(const std::string& file, std::string_view prefix);

}  // namespace slalom::view::mcap
