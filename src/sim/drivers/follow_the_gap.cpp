#include "slalom/sim/follow_the_gap.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace slalom::sim {
namespace {

using std::numbers::pi;

// The values of f1tenth_benchmarks.
constexpr int smoothing = 3;           // beams, of the mean over neighbours
constexpr std::size_t skipped = 135;   // beams at each end of the scan that are not used
constexpr double range_max = 10;       // m, longer ranges count as this
constexpr int bubble = 160;            // beams to each side of the nearest return that count as blocked
constexpr int min_gap = 5;             // beams; a gap must have more
constexpr int target_width = 80;       // beams, of the mean whose maximum is steered for
constexpr double largest_steer = 0.4;  // rad
constexpr double slow_above = 0.174;   // rad, of steering
constexpr double fast = 5, slow = 3;   // m/s

/// The mean over a window of `width` values; beyond the ends they are 0. As numpy.convolve in the mode `same`
/// with `width` ones: as many as the longer of both, the window of an even width begins half of it before.
std::vector<double> moving_mean(std::span<const double> values, int width) {
  const auto n = static_cast<int>(values.size()), count = std::max(n, width), narrow = std::min(n, width);
  std::vector<double> means;
  for (int i = 0; i < count; ++i) {
    // The window slides over the values, or, where it is wider, the values over the window.
    const int begin = i - narrow / 2, end = begin + narrow;
    double sum = 0;
    for (int k = std::max(begin, 0); k < std::min(end, count); ++k)
      sum += n >= width ? values[k] : values[end - 1 - k];
    means.push_back(sum / width);
  }
  return means;
}

}  // namespace

Command FollowTheGap::command(std::span<const double> scan) {
  if (scan.size() <= 2 * skipped) return {};
  ranges_ = moving_mean(scan.subspan(skipped, scan.size() - 2 * skipped), smoothing);
  for (double& range : ranges_) range = std::clamp(range, 0.0, range_max);
  const auto n = static_cast<int>(ranges_.size());
  const auto nearest = static_cast<int>(std::min_element(ranges_.begin(), ranges_.end()) - ranges_.begin());
  for (int i = std::max(0, nearest - bubble); i < std::min(nearest + bubble, n - 1); ++i) ranges_[i] = 0;

  int end = n, begin = n;
  for (; end > 0; end = begin) {
    while (end > 0 && ranges_[end - 1] == 0) --end;
    begin = end;
    while (begin > 0 && ranges_[begin - 1] != 0) --begin;
    if (end - begin > min_gap) break;
  }
  if (end == 0) return {};
  const auto gap = std::span(ranges_).subspan(begin, end - begin);
  const auto means = moving_mean(gap, target_width);
  const auto best = static_cast<int>(std::max_element(means.begin(), means.end()) - means.begin()) + begin;
  const double angle = (best - 0.5 * n) * (2 * pi / scan.size());
  const double steer = std::clamp(0.5 * angle, -largest_steer, largest_steer);
  return {steer, std::abs(steer) > slow_above ? slow : fast};
}

}  // namespace slalom::sim
