#pragma once

#include <stdexcept>
#include <string>

namespace slalom {

/// A file could not be read or written, or its contents break a rule. The message reads `file:line: what`,
/// naming the key, the value and the rule; the line is left out (0) where a file as a whole is meant.
class IoError : public std::runtime_error {
 public:
  /// An error in a line of a file; line 0: of the whole file.
  IoError(std::string file, int line, const std::string& what)
      : std::runtime_error(line > 0 ? file + ":" + std::to_string(line) + ": " + what : file + ": " + what),
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
