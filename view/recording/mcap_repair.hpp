#pragma once

#include <cstdint>
#include <ostream>
#include <string>

namespace slalom::view::mcap {

/// The rest of a recording that was cut.
struct Repaired {
  std::uint64_t messages = 0, attachments = 0;  ///< that are whole
  std::uint64_t lost = 0;                       ///< bytes behind the last whole record
};

/// Writes all whole records of a recording, with new indexes, as a finished recording. One that was finished
/// gives the same bytes. Throws IoError if the file is not an MCAP recording or cannot be read.
Repaired repair(const std::string& file, std::ostream& out);

}  // namespace slalom::view::mcap
