#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <string>

#include "bridge/frames.hpp"

namespace slalom_bridge::testing {

/// The transforms from one frame to another of the last ten seconds: like tf2, which these tests do without,
/// it interpolates, discards what is not finite and never extrapolates.
class TransformHistory {
 public:
  void add(Stamp stamp, const Pose& pose) {
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) return;
    if (!past_.empty() && stamp <= past_.back().stamp) return;
    past_.push_back({stamp, pose});
    constexpr Stamp longest = 10'000'000'000;  // ns
    while (past_.back().stamp - past_.front().stamp > longest) past_.pop_front();
  }
  void clear() { past_.clear(); }

  bool knows(Stamp stamp) const {
    return !past_.empty() && past_.front().stamp <= stamp && stamp <= past_.back().stamp;
  }
  /// Throws std::runtime_error if the pose of this time is not known.
  Pose at(Stamp stamp) const {
    if (past_.empty()) throw std::runtime_error("there is no transform");
    if (!knows(stamp)) throw std::runtime_error("the lookup would require extrapolation");
    const auto after = std::lower_bound(past_.begin(), past_.end(), stamp,
                                        [](const Entry& entry, Stamp time) { return entry.stamp < time; });
    if (after->stamp == stamp) return after->pose;
    const auto before = after - 1;
    const double share = in_seconds(stamp - before->stamp) / in_seconds(after->stamp - before->stamp);
    return {before->pose.x + share * (after->pose.x - before->pose.x),
            before->pose.y + share * (after->pose.y - before->pose.y),
            before->pose.yaw + share * std::remainder(after->pose.yaw - before->pose.yaw, 6.283185307179586)};
  }

 private:
  struct Entry {
    Stamp stamp;
    Pose pose;
  };
  std::deque<Entry> past_;  ///< by their stamps
};

/// The pose `inner`, which is relative to `outer`.
inline Pose composed(const Pose& outer, const Pose& inner) {
  const double c = std::cos(outer.yaw), s = std::sin(outer.yaw);
  return {outer.x + c * inner.x - s * inner.y, outer.y + s * inner.x + c * inner.y, outer.yaw + inner.yaw};
}

}  // namespace slalom_bridge::testing
