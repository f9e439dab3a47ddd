#pragma once

#include <functional>

namespace slalom::evaluation {

/// Calls `work` in `threads` threads, the caller's included, and returns when all have ended; `work` must not
/// throw. If the system cannot start a thread, goes on with those that run. Returns their number, at least 1.
int run_in_threads(int threads, const std::function<void()>& work);

}  // namespace slalom::evaluation
