#include "tools/recording/record_lines.hpp"

#include <filesystem>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::tools {

RecordLines::RecordLines(const std::string& file) : file_(file) {
  if (std::filesystem::is_directory(file)) throw IoError(file, 0, "is a folder; a recording is a file");
  if (!std::filesystem::is_regular_file(file))
    throw IoError(file, 0, "cannot be read: it must be a regular file");
  stream_.open(file, std::ios::binary | std::ios::ate);
  if (!stream_) throw cannot_open(file);
  size_ = static_cast<std::uint64_t>(stream_.tellg());
  if (size_ > max_bytes)
    throw IoError(
        file, 0,
        "has " + std::to_string(size_) + " bytes; at most " + std::to_string(max_bytes) + " are read");
  stream_.seekg(0);
}

bool RecordLines::next(std::string& line) {
  line.clear();
  ++number_;
  ended_ = true;
  for (int c = stream_.get(); c != std::istream::traits_type::eof(); c = stream_.get()) {
    if (c == '\n') return true;
    if (line.size() == max_line)
      throw IoError(file_, number_,
                    "is longer than " + std::to_string(max_line) + " bytes: it is not a record");
    line += static_cast<char>(c);
  }
  if (stream_.bad()) throw IoError(file_, number_, "cannot be read");
  ended_ = false;
  return !line.empty();
}

}  // namespace slalom::tools
