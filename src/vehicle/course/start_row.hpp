#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slalom::vehicle::detail {

/// The row in the middle of the longest part of a closed line at (nearly) the highest speed: a start with a
/// free view.
inline std::size_t start_row(const std::vector<double>& speed) {
  const std::size_t n = speed.size();
  const double fast = 0.97 * *std::max_element(speed.begin(), speed.end());
  std::size_t best = 0, best_run = 0, run = 0;
  for (std::size_t i = 0; i < 2 * n; ++i) {
    run = speed[i % n] >= fast ? std::min(run + 1, n) : 0;
    if (run > best_run) {
      best_run = run;
      best = (i + n - run / 2) % n;
    }
  }
  return best;
}

}  // namespace slalom::vehicle::detail
