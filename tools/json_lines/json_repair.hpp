#pragma once

#include <cstdint>
#include <ostream>
#include <string>

namespace slalom::tools {

/// Whether a file begins as a recording in JSON lines does: with a brace. False for what cannot be read and
/// for what is not a regular file.
bool is_json_recording(const std::string& file);

/// The rest of a recording in JSON lines that was cut.
struct RepairedLines {
  std::uint64_t records = 0;  ///< whole lines
  std::uint64_t lost = 0;     ///< bytes of the last line, if it is not whole
};

/// Writes all whole lines of a recording in JSON lines. Throws IoError with file and line if the file cannot
/// be read, does not begin with the first line of a recording, or if a line other than the last one is not a
/// record: then it was not cut, but changed.
RepairedLines repair_json_recording(const std::string& file, std::ostream& out);

}  // namespace slalom::tools
