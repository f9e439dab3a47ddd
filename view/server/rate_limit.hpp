#pragma once

#include <algorithm>
#include <chrono>

namespace slalom::view {

/// Limits a rate by a token bucket: `burst` events at once, `per_second` on average.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimit(double per_second, double burst, Clock::time_point now = Clock::now())
      : per_second_(per_second), burst_(burst), allowance_(burst), last_(now) {}

  /// Whether an event is within the limit; it then counts.
  bool allow(Clock::time_point now = Clock::now()) {
    const double passed = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    allowance_ = std::min(burst_, allowance_ + passed * per_second_);
    if (allowance_ < 1) return false;
    allowance_ -= 1;
    return true;
  }

 private:
  double per_second_, burst_;
  double allowance_;  ///< events that are allowed now
  Clock::time_point last_;
};

}  // namespace slalom::view
