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

}  // namespace slalom::tools
