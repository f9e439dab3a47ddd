#pragma once

#include <atomic>
#include <functional>

namespace slalom::evaluation {

/// Calls `work` with 0 to count - 1, each once, in up to `threads` threads, the caller's included; in fewer
/// where the system cannot start as many. Stops early when `cancel` (may be null) is set, or when a call
/// throws, and throws what the first of these threw.
void for_each_in_threads(int threads, int count, const std::function<void(int)>& work,
                         const std::atomic<bool>* cancel = nullptr);

}  // namespace slalom::evaluation
