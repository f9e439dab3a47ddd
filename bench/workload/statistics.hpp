#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace slalom::workload {

/// Order statistics of measured times.
struct TimeStatistics {
  double min = 0, p50 = 0, p99 = 0, max = 0;
};

inline TimeStatistics time_statistics(std::vector<double> times) {
  if (times.empty()) return {};
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(std::round(share * static_cast<double>(times.size() - 1)))];
  };
  return {times.front(), at(0.5), at(0.99), times.back()};
}

}  // namespace slalom::workload
