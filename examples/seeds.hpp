#pragma once

#include <cstdint>
#include <cstdio>

/// The number of seeds 0 ... 19 that succeed.
template <class Run>
int succeeded(Run run) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) count += run(seed);
  return count;
}

/// Prints the figures of both methods. The exit code is 0 if svg_mppi succeeds at least `required` times of
/// 20 and, with `compare`, at least as often as mppi.
inline int report(const char* what, int mppi, int svg_mppi, int required, bool compare = false) {
  std::printf("%s: mppi %d of 20 seeds, svg_mppi %d of 20\n", what, mppi, svg_mppi);
  return svg_mppi >= required && (!compare || svg_mppi >= mppi) ? 0 : 1;
}
