#pragma once

#include <atomic>
#include <functional>

namespace slalom::evaluation {

/// Calls `work` in `threads` threads, the caller's included, and returns when all have ended; `work` must not
/// throw. If the system cannot start a thread, goes on with those that run. Returns their number, at least 1.
int run_in_threads(int threads, const std::function<void()>& work);

/// Calls `work` with 0 to count - 1, each once, in up to `threads` threads. Stops early when `cancel` (may be
/// null) is set, or when a call throws, and throws what the first of these threw.
void for_each_in_threads(int threads, int count, const std::function<void(int)>& work,
                         const std::atomic<bool>* cancel = nullptr);

}  // namespace slalom::evaluation
