#pragma once

#include <stdexcept>
#include <string>

namespace slalom {

/// A message that repeats long values, without its middle: at most 1000 bytes, whole characters of UTF-8.
inline std::string shortened(std::string message) {
  constexpr std::size_t most = 1000, part = 490;
  if (message.size() <= most) return message;
  std::size_t from = part, to = message.size() - part;
  while (from > 0 && (message[from] & 0xc0) == 0x80) --from;
  while (to < message.size() && (message[to] & 0xc0) == 0x80) ++to;
  return message.replace(from, to - from, " ... ");
}

/// A file could not be read or written, or its contents break a rule. The message reads `file:line: what`,
/// naming the key, the value and the rule; the line is left out (0) where a file as a whole is meant.
class IoError : public std::runtime_error {
 public:
  /// An error in a line of a file; line 0: of the whole file.
  IoError(std::string file, int line, const std::string& what)
      : std::runtime_error(shortened((line > 0 ? file + ":" + std::to_string(line) : file) + ": " + what)),
        file_(std::move(file)),
        line_(line) {}

  /// Name of the file, as given.
  const std::string& file() const noexcept { return file_; }
  /// Line from 1; 0 for the whole file.
  int line() const noexcept { return line_; }

 private:
  std::string file_;
  int line_;
};

}  // namespace slalom
