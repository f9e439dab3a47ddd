#pragma once

#include <cstdint>
#include <fstream>
#include <string>

namespace slalom::tools {

/// The lines of a recording in JSON lines, one at a time.
class RecordLines {
 public:
  static constexpr std::uint64_t max_bytes = std::uint64_t{1} << 32;  ///< size of a recording
  static constexpr std::size_t max_line = std::size_t{1} << 22;       ///< bytes of a line, without its end

  /// Throws IoError if the file does not exist or cannot be read, is not a regular file (a pipe could block
  /// for ever), or has more than `max_bytes`.
  explicit RecordLines(const std::string& file);

  /// Reads the next line, without its end; false at the end of the file. Throws IoError if the line is longer
  /// than `max_line`.
  bool next(std::string& line);

  const std::string& file() const noexcept { return file_; }
  int number() const noexcept { return number_; }        ///< number of the line that was read last, from 1
  bool ended() const noexcept { return ended_; }         ///< whether that line had its end, a newline
  std::uint64_t size() const noexcept { return size_; }  ///< bytes of the file

 private:
  std::string file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  int number_ = 0;
  bool ended_ = true;
};

}  // namespace slalom::tools
