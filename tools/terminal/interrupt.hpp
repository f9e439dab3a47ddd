#pragma once

#include <atomic>

namespace slalom::tools {

/// From construction to destruction Ctrl-C and SIGTERM do not end the program but raise a flag; a second one
/// ends it at once.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;

  const std::atomic<bool>& raised() const noexcept;
};

/// Returns the exit status of the program: that of a shell for the signal, such as 130 for Ctrl-C, if a
/// signal stopped a command before its end (`status` 1), else `status`.
int exit_status(int status) noexcept;

}  // namespace slalom::tools
